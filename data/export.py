"""Tracks into files by their ending: text for Tracker's import, CSV, Parquet."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from curlshot.data.errors import InputError
from curlshot.data.files import check_folder, whole_file
from curlshot.data.trk import TEXT_COLUMNS

_WHERE_TOLD = ("sd_place_x", "sd_place_y", "rise_a", "rise_b", "team")
"""Columns of a CSV only where there is something in them."""


def write_text(detections: pd.DataFrame, path: Path) -> None:
    """Write what Tracker reads with File > Import > Text Data File, tabs between the cells.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    path : Path
        File to write, whole or not at all.

    Raises
    ------
    InputError
        Two stones whose names differ by blanks only, which Tracker does not allow in names.

    Notes
    -----
    One stone: its name, then t, x, y. Several: pairs such as ``x_A, y_A``. All numbers have as
    many digits as it takes to read the same number again. Angles, errors and frames follow in
    columns that Tracker does not need; none begins or ends with x or y, as places do there.
    """
    stones = list(dict.fromkeys(detections["stone"]))
    labels = {stone: "_".join(stone.split()) for stone in stones}
    doubled = [label for label in labels.values() if list(labels.values()).count(label) > 1]
    if doubled:
        raise InputError(f"{path}: two stones named {doubled[0]} without blanks; rename one")
    one = len(stones) == 1
    by_frame = detections.drop_duplicates("frame").set_index("frame")["t"].sort_index()
    columns = {"t": [_time(t) for t in by_frame]}
    beside: dict[str, list[str]] = {}
    for stone in stones:
        rows = detections[detections["stone"] == stone].set_index("frame").reindex(by_frame.index)
        end = "" if one else f"_{labels[stone]}"
        columns[f"x{end}"] = [_number(v) for v in rows["x"]]
        columns[f"y{end}"] = [_number(v) for v in rows["y"]]
        for name, label in TEXT_COLUMNS.items():
            if rows[name].notna().any():
                whose = label.replace("(", f"{end}(")
                beside[whose] = [_number(v) for v in rows[name]]
    columns |= beside
    columns["frame"] = [str(frame) for frame in by_frame.index]
    lines = [labels[stones[0]]] if one else []
    lines.append("\t".join(columns))
    lines += ["\t".join(row) for row in zip(*columns.values(), strict=True)]
    with whole_file(path) as part:
        part.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def write_csv(detections: pd.DataFrame, path: Path) -> None:
    """Write one row per stone and time, every number with all its digits."""
    empty = [name for name in _WHERE_TOLD if detections[name].isin(["", np.nan]).all()]
    table = detections.drop(columns=empty).assign(t=[_time(t) for t in detections["t"]])
    with whole_file(path) as part:
        table.to_csv(part, index=False, lineterminator="\n")


def write_parquet(detections: pd.DataFrame, path: Path) -> None:
    """Write one row per stone and time as Parquet; raises `InputError` without pyarrow."""
    need_pyarrow(path)
    with whole_file(path) as part:
        detections.to_parquet(part, engine="pyarrow", index=False)


WRITERS: Mapping[str, Callable[[pd.DataFrame, Path], None]] = {
    ".txt": write_text,
    ".csv": write_csv,
    ".parquet": write_parquet,
}
"""What writes tracks into a file, by its ending."""

PROJECTS = (".trk", ".trz")
"""Endings of Tracker's projects; a .trz is an archive that holds the clip too."""


def check_target(path: Path, inputs: Sequence[Path]) -> None:
    """Refuse to write what there is no form for, where nothing can be, or onto an input.

    Raises
    ------
    InputError
        One line that says why.
    """
    endings = (*WRITERS, *PROJECTS)
    if path.suffix.lower() not in endings:
        raise InputError(
            f"{path}: tracks can be written as {', '.join(endings)}; give the name one of these"
            " endings"
        )
    check_folder(path.parent, how="")
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name another file to write")
    if path.resolve() in {file.resolve() for file in inputs}:
        raise InputError(f"{path}: is the file to convert; name another file to write")


def read_parquet(path: Path) -> pd.DataFrame:
    """Read a table of Parquet.

    Raises
    ------
    InputError
        One line: no pyarrow, no such file, or no Parquet.
    """
    need_pyarrow(path)
    try:
        return pd.read_parquet(path, engine="pyarrow")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except ValueError as error:
        raise InputError(f"{path}: no Parquet ({' '.join(str(error).split())[:80]})") from None


def need_pyarrow(path: Path) -> None:
    """Raise `InputError` where the library for Parquet is missing."""
    if importlib.util.find_spec("pyarrow") is None:
        raise InputError(
            f"{path}: Parquet needs pyarrow, which is not installed: pip install pyarrow"
        )


def _time(t: float) -> str:
    """Print a time so that it does not look rounded to fewer digits than it has."""
    plain = f"{t:.6f}"
    return plain if float(plain) == t else repr(float(t))


def _number(value: float) -> str:
    return "" if np.isnan(value) else repr(float(value))
