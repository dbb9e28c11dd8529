"""Files behind the names that a person gives."""

from __future__ import annotations

import glob
import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path

from curlshot.data.errors import InputError

IMAGE_SUFFIXES = frozenset({".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"})

PROJECT_SUFFIXES = frozenset({".trk", ".trz", ".zip"})

TABLE_SUFFIXES = PROJECT_SUFFIXES | {".csv", ".txt", ".tsv", ".dat", ".parquet"}

SPREADSHEETS = frozenset({".ods", ".xls", ".xlsx"})

SPREADSHEET = "a spreadsheet; save it as CSV"
"""What is said of them, and of archives that are one under another name."""


def named(names: str | Path | Iterable[str | Path]) -> tuple[str | Path, ...]:
    """Give names as several, also where there is one alone: a text has letters, which are none."""
    return (names,) if isinstance(names, str | Path) else tuple(names)


def find_inputs(names: str | Path | Sequence[str | Path]) -> tuple[Path, ...]:
    """Files behind what a person names: files, globs, folders of pictures.

    Where a shell named pictures and clips they come in natural order, tables as they are named.

    Raises
    ------
    InputError
        Something that is not there, a folder without pictures, or an empty name.
    """
    found: list[Path] = []
    for name in named(names):
        if not str(name).strip():  # as of an unset variable; it would be the working folder
            raise InputError("an empty name; name a clip, pictures or a table of tracks")
        path = Path(name)
        if path.is_dir():
            pictures = [p for p in path.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES]
            if not pictures and (path / "tracks.csv").exists():
                raise InputError(f"{path}: the folder of a run; name its {path / 'tracks.csv'}")
            if not pictures:
                raise InputError(
                    f"{path}: no pictures in this folder; clips are named as {path / '*.mp4'}"
                )
            found += sorted(pictures, key=_natural)
        elif path.exists():
            found.append(path)
        else:
            matches = matching(name)
            if not matches:
                raise InputError(f"{name}: no such file")
            found += matches
    if not found:
        raise InputError("no input; name a clip, pictures or a table of tracks")
    tables = any(path.suffix.lower() in TABLE_SUFFIXES for path in found)
    return tuple(found if tables else in_order(found))


def in_order(paths: Iterable[Path]) -> list[Path]:
    """Put names of a shell in natural order, which has 10 before 9; a person's own order stays.

    A shell's go up the alphabet, or differ in numbers alone, whatever alphabet its country has.
    """
    runs: list[list[Path]] = []
    for path in paths:
        before = runs[-1][-1] if runs else None
        if before is not None and (before <= path or _numberless(before) == _numberless(path)):
            runs[-1].append(path)
        else:
            runs.append([path])
    return [path for run in runs for path in sorted(run, key=_natural)]


def matching(name: str | Path) -> list[Path]:
    """Files and folders that match a pattern, in natural order: not every shell looks for them."""
    path = Path(name)
    # The folder may have brackets in its name; only if it is none, it is a pattern too.
    there = path.parent.is_dir()
    pattern = Path(glob.escape(str(path.parent)), path.name) if there else path
    # Path.glob takes no absolute pattern, nor two stars within a name.
    found = map(Path, glob.glob(str(pattern)))  # noqa: PTH207
    return sorted(found, key=_natural)


def picture_times(paths: Sequence[Path]) -> list[float] | None:
    """When pictures were taken that are numbered in their names, in steps of most of them.

    Pictures that were taken out of a sequence leave holes in its numbers, and time passed there.

    Returns
    -------
    list of float or None
        Starting with 0, one step from most pictures to the next; None where the names do not differ
        by a rising number alone.
    """
    parts = [re.findall(r"\d+|\D+", path.name) for path in paths]
    if len(paths) < 2 or len({len(p) for p in parts}) > 1:
        return None
    differ = [i for i, here in enumerate(zip(*parts, strict=True)) if len(set(here)) > 1]
    if len(differ) != 1 or not all(p[differ[0]].isdecimal() for p in parts):
        return None
    numbers = [int(p[differ[0]]) for p in parts]
    steps = [after - before for before, after in pairwise(numbers)]
    if min(steps) <= 0:
        return None
    usual = sorted(steps)[(len(steps) - 1) // 2]
    return [(number - numbers[0]) / usual for number in numbers]


def _numberless(path: Path) -> str:
    """Give a name with all numbers alike."""
    return re.sub(r"\d+", "0", str(path))


def _natural(path: Path) -> list[list[tuple[int, str]]]:
    """Sort key by which picture 9 comes before picture 10, and folder 9 before folder 10."""
    parts = [re.findall(r"\d+|\D+", part) for part in path.parts]
    return [[(int(p), "") if p.isdecimal() else (-1, p) for p in part] for part in parts]


def sample_clip() -> Path:
    """Return the path of the bundled, rendered clip of the paper's shot.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.sample_clip().name
    'sample.mp4'
    """
    return Path(__file__).resolve().parent / "sample.mp4"
