"""Tracker's projects wherever they are kept: a ``.trk``, or an archive (``.trz``) of some."""

from __future__ import annotations

import zipfile
import zlib
from dataclasses import replace
from pathlib import Path, PurePosixPath

from data.errors import InputError
from data.osp_xml import LARGEST, Thing, parse
from data.trk import Project, project_of

MOST_ENTRIES = 100_000
"""Files in an archive; a clip of single pictures has thousands."""

MOST_TABS = 50
"""Projects in one archive."""

_ARCHIVE = b"PK\x03\x04"
_UNREADABLE = (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError)
"""What `zipfile` raises for damaged, exotic and encrypted entries."""


def is_project(path: Path) -> bool:
    """Tell from its first bytes whether a file is an archive or XML."""
    try:
        with path.open("rb") as file:
            head = file.read(200)
    except (OSError, ValueError):
        return False
    return head.startswith(_ARCHIVE) or head.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] == b"<"


def read_project(path: Path, tab: str | None = None) -> Project:
    """Read one tab of a project.

    Parameters
    ----------
    path : Path
        A ``.trk``, or an archive that holds some.
    tab : str, optional
        Name of the tab: of its ``.trk``, without the ending. If not given, the first that has
        marks; a warning names the others.

    Raises
    ------
    InputError
        One line: damaged, no project, nothing marked, or no such tab.
    """
    tabs = _tabs(path)
    names = ", ".join(tabs)
    if tab is not None:
        if tab not in tabs:
            raise InputError(f"{path}: no tab {tab}; there is {names}")
        return project_of(tabs[tab], str(path))
    faults: list[InputError] = []
    for name, root in tabs.items():
        try:
            project = project_of(root, str(path))
        except InputError as error:
            faults.append(error)
            continue
        if len(tabs) == 1:
            return project
        note = f"{path}: of the tabs {names}, the first with marks is used: {name} (--tab)"
        return replace(project, warnings=(note, *project.warnings))
    raise faults[0]


def _tabs(path: Path) -> dict[str, Thing]:
    """Read the root objects of all projects in a file, by name."""
    try:
        if path.stat().st_size > LARGEST and not zipfile.is_zipfile(path):
            raise InputError(f"{path}: too large for a Tracker project")
        if not zipfile.is_zipfile(path):
            root = parse(path.read_bytes(), str(path))
            return _linked(path, root) if root.cls == "TFrame" else {path.stem: root}
        with zipfile.ZipFile(path) as archive:
            return _archived(path, archive)
    except _UNREADABLE as error:
        raise InputError(f"{path}: damaged archive ({error})") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None


def _archived(path: Path, archive: zipfile.ZipFile) -> dict[str, Thing]:
    """Projects in an archive. Names in it are never used as paths, so ``..`` does no harm."""
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        raise InputError(f"{path}: {len(entries)} files are too many for a Tracker project")
    found = [e for e in entries if e.filename.lower().endswith(".trk") and not _hidden(e.filename)]
    if not found:
        raise InputError(f"{path}: an archive without a Tracker project (.trk)")
    if len(found) > MOST_TABS:
        raise InputError(f"{path}: {len(found)} projects in one archive are too many")
    tabs: dict[str, Thing] = {}
    for entry in found:
        # Read no more than is allowed, whatever size the archive promises.
        with archive.open(entry) as file:
            raw = file.read(LARGEST + 1)
        root = parse(raw, f"{path}: {entry.filename[-80:]}")
        if root.cls == "TrackerPanel":
            tabs.setdefault(PurePosixPath(entry.filename).stem, root)
    if not tabs:
        raise InputError(f"{path}: an archive without a Tracker project (.trk)")
    return tabs


def _hidden(name: str) -> bool:
    """Whether an entry is what a system keeps for itself, such as ``__MACOSX/._a.trk``."""
    return PurePosixPath(name).name.startswith(".")


def _linked(path: Path, root: Thing) -> dict[str, Thing]:
    """Projects that a set of tabs names, beside it."""
    listed = root.thing("tabs")
    tabs: dict[str, Thing] = {}
    for _, entry in sorted(listed.sparse().items())[:MOST_TABS] if listed is not None else ():
        names = [entry.text(f"[{k}]") for k in (1, 0)] if isinstance(entry, Thing) else []
        for name in names:
            there = path.parent / name
            if there.suffix.lower() == ".trk" and there.is_file():
                if there.stat().st_size <= LARGEST:
                    tabs.setdefault(there.stem, parse(there.read_bytes(), str(there)))
                break
    if not tabs:
        raise InputError(f"{path}: a set of tabs whose projects are not beside it")
    return tabs
