"""Tracker's projects wherever they are kept: a ``.trk``, or an archive (``.trz``) of some."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePath, PurePosixPath

from curlshot.data.archive import UNREADABLE, unpack
from curlshot.data.errors import InputError
from curlshot.data.inputs import SPREADSHEET, TABLE_SUFFIXES
from curlshot.data.osp_xml import LARGEST, Thing, parse
from curlshot.data.trk import Project
from curlshot.data.trk_read import project_of

MOST_ENTRIES = 100_000
"""Files in an archive; a clip of single pictures has thousands."""

MOST_TABS = 50
"""Projects in one archive."""

_ARCHIVE = b"PK\x03\x04"


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
        One line: damaged, no project, or no such tab.
    """
    project, _ = _chosen(path, tab, "marks", lambda project: bool(project.masses))
    return project


def unpack_clip(path: Path, tab: str | None, folder: Path) -> tuple[Project, tuple[Path, ...]]:
    """Find the clip of a project, beside it or in its archive.

    Parameters
    ----------
    path : Path
        A ``.trk``, or an archive that holds some.
    tab : str, optional
        Name of the tab. If not given, the first that has a clip; a warning names the others.
    folder : Path
        What is in an archive is unpacked into this folder.

    Returns
    -------
    Project
        The tab.
    tuple of Path
        Its video, or its pictures in order.

    Raises
    ------
    InputError
        One line: damaged, no clip, a clip that is not there, or one that is too large.
    """
    project, place = _chosen(path, tab, "a clip", lambda project: bool(project.video))
    if not project.video:
        raise InputError(f"{path}: a project without a clip")
    try:
        if place.archived:
            with zipfile.ZipFile(path) as archive:
                return project, unpack(archive, path, place.folder, project.video, folder)
        return project, tuple(_beside(path, Path(place.folder), name) for name in project.video)
    except UNREADABLE as error:
        raise InputError(f"{path}: damaged archive ({error})") from None
    except OSError as error:
        raise InputError(f"{path}: its clip cannot be unpacked ({error.strerror})") from None


@dataclass(frozen=True)
class _Tab:
    """The root object of a project, and the folder from which it names its clip."""

    root: Thing
    folder: PurePath
    archived: bool = False


def _chosen(
    path: Path, tab: str | None, what: str, suits: Callable[[Project], bool]
) -> tuple[Project, _Tab]:
    """Read the tab of that name, or the first that suits, or the first."""
    tabs = _tabs(path)
    names = ", ".join(tabs)
    if tab is not None:
        if tab not in tabs:
            raise InputError(f"{path}: no tab {tab}; there is {names}")
        return project_of(tabs[tab].root, str(path)), tabs[tab]
    sound: list[tuple[Project, _Tab]] = []
    faults: list[InputError] = []
    for name, place in tabs.items():
        try:
            project = project_of(place.root, str(path))
        except InputError as error:
            faults.append(error)
            continue
        sound.append((project, place))
        if len(tabs) > 1 and suits(project):
            note = f"{path}: of the tabs {names}, the first with {what} is used: {name} (`tab`)"
            return replace(project, warnings=(note, *project.warnings)), place
    if not sound:
        raise faults[0]
    return sound[0]


def _tabs(path: Path) -> dict[str, _Tab]:
    """Read the root objects of all projects in a file, by name."""
    try:
        if not zipfile.is_zipfile(path):
            if path.stat().st_size > LARGEST:
                raise InputError(f"{path}: too large for a Tracker project")
            raw = path.read_bytes()
            if raw.startswith(_ARCHIVE):
                raise InputError(f"{path}: damaged archive (its end is missing)")
            root = parse(raw, str(path))
            if root.cls == "TFrame":
                return _linked(path, root)
            return {path.stem: _Tab(root, path.parent)}
        with zipfile.ZipFile(path) as archive:
            return _archived(path, archive)
    except UNREADABLE as error:
        raise InputError(f"{path}: damaged archive ({error})") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None


def _archived(path: Path, archive: zipfile.ZipFile) -> dict[str, _Tab]:
    """Projects in an archive. Names in it are never used as paths, so ``..`` does no harm."""
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        raise InputError(f"{path}: {len(entries)} files are too many for a Tracker project")
    found = [e for e in entries if e.filename.lower().endswith(".trk") and not _hidden(e.filename)]
    if not found:
        raise InputError(f"{path}: {_other_archive(entries)}")
    if len(found) > MOST_TABS:
        raise InputError(f"{path}: {len(found)} projects in one archive are too many")
    tabs: dict[str, _Tab] = {}
    for entry in found:
        # Read no more than is allowed, whatever size the archive promises.
        with archive.open(entry) as file:
            raw = file.read(LARGEST + 1)
        root = parse(raw, f"{path}: {entry.filename[-80:]}")
        if root.cls == "TrackerPanel":
            name = PurePosixPath(entry.filename)
            tabs.setdefault(name.stem, _Tab(root, name.parent, archived=True))
    if not tabs:
        raise InputError(f"{path}: an archive without a Tracker project (.trk)")
    return tabs


def _other_archive(entries: Sequence[zipfile.ZipInfo]) -> str:
    """Say what an archive is that holds no project, and what to do with it."""
    names = [entry.filename for entry in entries]
    if any(name.startswith("xl/") or name == "content.xml" for name in names):
        return SPREADSHEET
    inside = [name for name in names if PurePosixPath(name).suffix.lower() in TABLE_SUFFIXES]
    if inside:
        return f"an archive with {inside[0][-80:]} in it; unpack it first"
    return "an archive without a Tracker project (.trk)"


def _beside(path: Path, folder: Path, name: str) -> Path:
    """Find a file that a project names: where it says, or under its bare name beside it."""
    bare = re.split(r"[/\\]", name)[-1]
    for there in (folder / name, folder / bare):
        try:
            if there.is_file():
                return there
        except (OSError, ValueError):  # a name that is none
            continue
    raise InputError(
        f"{path}: its clip {bare[:80]} is missing; put it into the folder of the project"
    )


def _hidden(name: str) -> bool:
    """Whether an entry is what a system keeps for itself, such as ``__MACOSX/._a.trk``."""
    return PurePosixPath(name).name.startswith(".")


def _linked(path: Path, root: Thing) -> dict[str, _Tab]:
    """Projects that a set of tabs names, beside it."""
    listed = root.thing("tabs")
    tabs: dict[str, _Tab] = {}
    for _, entry in sorted(listed.sparse().items())[:MOST_TABS] if listed is not None else ():
        names = [entry.text(f"[{k}]") for k in (1, 0)] if isinstance(entry, Thing) else []
        for name in names:
            there = path.parent / name
            if there.suffix.lower() == ".trk" and there.is_file():
                if there.stat().st_size <= LARGEST:
                    root = parse(there.read_bytes(), str(there))
                    tabs.setdefault(there.stem, _Tab(root, there.parent))
                break
    if not tabs:
        raise InputError(f"{path}: a set of tabs without its projects in the same folder")
    return tabs
