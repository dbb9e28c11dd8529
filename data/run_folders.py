"""Folders of runs: one for each clip, and their results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from curlshot.data.errors import InputError
from curlshot.data.files import check_folder
from curlshot.data.inputs import in_order, matching, named
from curlshot.data.text import printable

if TYPE_CHECKING:
    from curlshot.data.results import Results


def apart(clips: Sequence[Path]) -> dict[str, Path]:
    """Name clips by their stems, by those of their folders too where stems are shared."""
    named: dict[str, Path] = {}
    stems = [printable(clip.stem) for clip in clips]
    # Windows and macOS take Shot and shot for one folder.
    same, taken = [stem.casefold() for stem in stems], set[str]()
    for number, (clip, name) in enumerate(zip(clips, stems, strict=True)):
        if same.count(name.casefold()) > 1:
            name = f"{printable(clip.resolve().parent.name)}-{name}"
        if name.casefold() in taken:
            name = f"{name}-{number + 1}"
        taken.add(name.casefold())
        named[name] = clip
    return named


def find_results(names: str | Path | Sequence[str | Path]) -> dict[str, Path]:
    """Find the results of runs: of their folders, of folders of such folders, files or globs.

    Returns
    -------
    dict of str to Path
        Each ``results.json``, by the name of its folder; in natural order as a shell names them.

    Raises
    ------
    InputError
        Where there are none.
    """
    found: list[Path] = []
    given = in_order(Path(name) for name in named(names))
    paths = [[path] if path.exists() else matching(path) or [path] for path in given]
    for path in (path for some in paths for path in some):
        here = path / "results.json" if path.is_dir() else path
        inside = matching(path / "*") if path.is_dir() else []
        below = [file for one in inside if (file := one / "results.json").exists()]
        if not here.exists() and not below:
            raise InputError(f"{here}: no such file; name the folders of runs")
        found += [here] if here.exists() else below
    if not found:
        raise InputError("no runs given; name their folders")
    unique = dict.fromkeys(path.resolve() for path in found)
    folders = apart([path.parent.with_name(f"{path.parent.name}.run") for path in unique])
    return dict(zip(folders, unique, strict=True))


def season_folder(out: str | Path) -> Path:
    """Return the folder for what many shots show; refuse one that holds a run itself."""
    folder = check_folder(out)
    if (folder / "results.json").exists():
        raise InputError(f"{folder}: holds a run itself; name another folder with `out`")
    return folder


def read_runs(files: Mapping[str, Path]) -> dict[str, Results]:
    """Read the results of runs, by name.

    Raises
    ------
    InputError
        Where one is no results.json, or not all are of discs of one size.
    """
    from curlshot.data.results_file import read_results

    runs = {name: read_results(path) for name, path in files.items()}
    first, *others = runs
    for name in others:
        if runs[name].radius != runs[first].radius:
            raise InputError(
                f"{name}: its discs have a radius of {runs[name].radius:g} m, those of {first}"
                f" {runs[first].radius:g} m; name runs with the same discs"
            )
    return runs
