"""Files behind the names that a person gives."""

from __future__ import annotations

import glob
import re
from collections.abc import Sequence
from pathlib import Path

from data.errors import InputError

IMAGE_SUFFIXES = frozenset({".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"})

PROJECT_SUFFIXES = frozenset({".trk", ".trz", ".zip"})

TABLE_SUFFIXES = PROJECT_SUFFIXES | {".csv", ".txt", ".tsv", ".dat", ".parquet"}


def find_inputs(names: Sequence[str | Path]) -> tuple[Path, ...]:
    """Files behind what a person names: files, globs, folders of pictures in natural order.

    Raises
    ------
    InputError
        Something that is not there, or a folder without pictures.
    """
    found: list[Path] = []
    for name in names:
        path = Path(name)
        if path.is_dir():
            pictures = [p for p in path.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES]
            if not pictures:
                raise InputError(
                    f"{path}: no pictures in this folder; clips are named as {path / '*.mp4'}"
                )
            found += sorted(pictures, key=_natural)
        elif path.exists():
            found.append(path)
        else:
            # The folder may have brackets in its name; only if it is none, it is a pattern too.
            matches = (
                list(path.parent.glob(path.name))
                if path.parent.is_dir()
                else [Path(match) for match in glob.glob(str(name))]  # noqa: PTH207 - absolute too
            )
            if not matches:
                raise InputError(f"{name}: no such file")
            found += sorted(matches, key=_natural)
    if not found:
        raise InputError("no input; name a clip, pictures or a table of tracks")
    return tuple(found)


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort key by which picture 9 comes before picture 10."""
    parts = re.findall(r"\d+|\D+", path.name)
    return [(int(p), "") if p.isdecimal() else (-1, p) for p in parts]
