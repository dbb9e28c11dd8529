"""Which column of a text table is what: the layouts in which people keep tracks.

One row per time with the stones side by side (Tracker's export, ``t, x1, y1, x2, y2``), one
row per stone and time (``stone, t, x, y``), or no header at all (``t x y``).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.columns import (
    clock_column,
    refuse_disorder,
    times_of,
    values_of,
    written_unit,
)
from curlshot.data.delimited import TextTable, read_text_table
from curlshot.data.errors import InputError
from curlshot.data.headers import ANGLE_NAMES, TIME_NAMES, plain_name
from curlshot.data.track_file import TrackFile
from curlshot.data.tracks import EARLIER_NAMES, MEASURED_AS, stone_name
from curlshot.data.units import ANGLE_UNITS, LENGTH_UNITS
from curlshot.data.wide import (
    COMPANIONS,
    Place,
    pairs_of,
    read_wide,
    side_by_side,
    title_of,
)

Array = NDArray[np.float64]


def read_layout(path: Path, fps: float | None) -> TrackFile:
    """Read the tracks in one file, in its own units.

    Parameters
    ----------
    path : Path
        The file.
    fps : float or None
        Rate of the rows where the file has no times, 1/s.

    Raises
    ------
    InputError
        One line that says what makes no sense and where.
    """
    table = read_text_table(path, _is_header)
    if not table.rows:
        raise InputError(f"{path}: a header without rows of data")
    if table.width < 2:
        raise InputError(f"{path}: only one column; needs t, x and y")
    names = None if table.names is None else [plain_name(name) for name in table.names]
    if names is None:
        file = _without_header(table, fps)
    elif "stone" in names:
        file = _tidy(table, names, fps)
    else:
        file = read_wide(table, names, fps)
    file.warnings[:0] = table.warnings
    if table.names is not None and names is not None:
        places = [names[k] for pair in pairs_of(table.names).values() for k in pair]  # as xa, redx
        file.length_unit = written_unit(table, names, ("x", "y", *places), LENGTH_UNITS)
        written = written_unit(table, names, tuple(ANGLE_NAMES), ANGLE_UNITS)
        file.angle_unit = written or file.angle_unit
    return file


def _is_header(cells: Sequence[str]) -> bool:
    names = [plain_name(cell) for cell in cells]
    placed = ("x" in names and "y" in names) or bool(pairs_of(cells))
    if not names[0]:  # rows are numbered before them; else it is a line of names of tracks
        return placed and (all(names[1:]) or not TIME_NAMES.isdisjoint(names))
    return names[0] in TIME_NAMES or placed


def _tidy(table: TextTable, names: Sequence[str], fps: float | None) -> TrackFile:
    """Read one row per stone and time, columns in any order."""
    names = [EARLIER_NAMES.get(name, name) for name in names]
    missing = [name for name in ("x", "y") if name not in names]
    if missing:
        raise InputError(f"{table.path}: no column {', '.join(missing)}; needs stone, t, x, y")
    doubled = [name for name, n in Counter(names).items() if n > 1 and name]
    if doubled:
        raise InputError(f"{table.path}: two columns named {doubled[0]}")
    if TIME_NAMES.isdisjoint(names) and "frame" not in names:
        raise InputError(f"{table.path}: no column t; needs stone, t, x, y")
    clock = clock_column(table, names, fps)
    known = ("x", "y", "seen", *COMPANIONS, *MEASURED_AS)
    wanted = {n: names.index(n) for n in known if n in names}
    values = values_of(table, wanted.values(), clock)
    times, decimals, warnings = times_of(table, values, clock, fps)
    stones = [stone.strip("\"'") for stone in table.cells([names.index("stone")])[0]]
    tracks = pd.DataFrame({"stone": stones, "t": times} | {n: values[k] for n, k in wanted.items()})
    if "team" in names:
        tracks["team"] = [team.strip("\"'") for team in table.cells([names.index("team")])[0]]
    used = tracks["x"].notna() & tracks["y"].notna()
    tracks = tracks[used]
    if "" in set(tracks["stone"]):
        row = int(np.flatnonzero(used.to_numpy() & (np.array(stones) == ""))[0])
        raise InputError(f"{table.path}: line {table.line_numbers[row]}: no name in column stone")
    if tracks.empty:
        raise InputError(f"{table.path}: no row with a place (x and y)")
    for name in sorted({*stones} - {*tracks["stone"], ""}):
        warnings.append(f"{table.path}: {name} has no place in any row; left out")
    # Tables that this program wrote are in radians, however fast a disc turns.
    unit = None if wanted.keys().isdisjoint(("seen", "sd_theta", *MEASURED_AS)) else "rad"
    return TrackFile(tracks, decimals, angle_unit=unit, continuous=True, warnings=warnings)


def _without_header(table: TextTable, fps: float | None) -> TrackFile:
    """Read ``t x y`` or ``t x1 y1 x2 y2``; with a frame rate also without the t."""
    width = table.width
    timeless = width % 2 == 0
    if timeless and fps is None:
        raise InputError(
            f"{table.path}: {width} columns without a header; needs t, x, y (and x, y of each"
            " further stone), or the frame rate (`fps`) where there is no t"
        )
    clock = None if timeless else 0
    values = values_of(table, range(width), clock)
    times, decimals, warnings = times_of(table, values, clock, fps)
    refuse_disorder(table, times)
    starts = range(0 if timeless else 1, width, 2)
    numbers = np.column_stack(list(values.values()))
    kept = [k for k in starts if k == starts[0] or not _is_velocity(times, numbers, k)]
    if len(kept) < len(starts):
        warnings.append(f"{table.path}: columns that are velocities of others are left out")
    stones = [title_of(table)] if len(kept) == 1 else [stone_name(k) for k in range(len(kept))]
    layout = ", ".join(("t", "x", "y") if not timeless else ("x", "y"))
    warnings.append(
        f"{table.path}: no header; read as {layout} of {len(kept)} stone"
        f"{'' if len(kept) == 1 else 's, named by order'}"
    )
    places = [Place(stone, k, k + 1) for stone, k in zip(stones, kept, strict=True)]
    return side_by_side(table, values, places, times, decimals, warnings)


def _is_velocity(times: Array, numbers: Array, column: int) -> bool:
    """Tell whether a pair of columns is the rate of change of the pair before it."""
    if len(times) < 5:
        return False
    here, before = numbers[:, column : column + 2], numbers[:, column - 2 : column]
    with np.errstate(all="ignore"):
        rate = np.gradient(before, times, axis=0)
        known = np.isfinite(rate).all(axis=1) & np.isfinite(here).all(axis=1)
        off = np.sqrt(np.mean((here - rate)[known] ** 2)) if known.any() else np.inf
        size = np.sqrt(np.mean(rate[known] ** 2)) if known.any() else 0.0
    return bool(off < 0.05 * size)
