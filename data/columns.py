"""Columns of a text table: their units, their numbers, and the times of the rows."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.data.delimited import TextTable
from curlshot.data.errors import InputError
from curlshot.data.headers import TIME_NAMES, bracketed, plain_name
from curlshot.data.text import plain_decimals
from curlshot.data.tracks import LATEST
from curlshot.data.units import LENGTH_UNITS, TIME_UNITS, abbreviated

Array = NDArray[np.float64]

UNIT_SAID = "another length unit than the file says, or another calibration"
UNIT_NOT_SAID = f"another length unit (`length_unit`: {', '.join(LENGTH_UNITS)})"
"""What may be wrong with lengths, where the file says their unit and where it does not."""


def written_unit(
    table: TextTable, plain: Sequence[str], wanted: Sequence[str], units: dict[str, float]
) -> str | None:
    """Find the unit in brackets behind the wanted columns.

    What stands behind all of them and is none of `units` is given as it stands; where other things
    stand behind some, these are names.

    Raises
    ------
    InputError
        Where two of the units are given.
    """
    found: list[str | None] = []
    for full, name in zip(table.names or plain, plain, strict=True):
        words = {name, *re.split(r"[_ .\d]+", name)}
        if "sd" not in words and not words.isdisjoint(wanted):
            bracket = bracketed(full)
            found.append(None if bracket is None else abbreviated(bracket))
    known = sorted({unit for unit in found if unit in units})
    if len(known) > 1:
        raise InputError(
            f"{table.path}: columns in {' and '.join(known)}; one unit for all, please"
        )
    return known[0] if known else found[0] if len(set(found)) == 1 else None


def clock_column(table: TextTable, names: Sequence[str], fps: float | None) -> int | None:
    """Find the column that tells the time, or the frame; None where the rows' number does."""
    for k, name in enumerate(names):
        if name in TIME_NAMES:
            return k
    if fps is None:
        there = ", ".join(name for name in names if name)[:80]
        raise InputError(
            f"{table.path}: no time column, t (there are {there}); rename it, or give the frame"
            " rate of the rows (`fps`)"
        )
    return names.index("frame") if "frame" in names else None


def times_of(
    table: TextTable, values: dict[int, Array], column: int | None, fps: float | None
) -> tuple[Array, int | None, list[str]]:
    """Find the times of the rows, s, to how many decimals they are printed, and warnings."""
    if column is None:
        return np.arange(len(table.rows)) / (fps or 1.0), None, []
    times = values[column]
    written = "" if table.names is None else table.names[column]
    (cells,) = table.cells([column])
    if fps is not None and plain_name(written) == "frame":
        return times / fps, None, []
    bracket = bracketed(written)
    minutes = ":" in "".join(cells)  # as in 0:01.25
    if bracket and minutes and not all(":" in cell for cell in cells):
        said = abbreviated(bracket)
        if TIME_UNITS.get(said, 1.0) != 1.0:
            raise InputError(
                f"{table.path}: some times are in {said}, others as 0:01.25; use one form for all"
            )
    if bracket and (minutes or bracket.lower() in TIME_NAMES):
        bracket = None  # nor does time (t) tell a unit
    told = abbreviated(bracket) if bracket else "s"
    if told not in TIME_UNITS:
        raise InputError(
            f"{table.path}: its time unit is “{told[:20]}”, which is unknown here; known are"
            f" {', '.join(TIME_UNITS)}; frames are a column frame and their rate (`fps`)"
        )
    unit = TIME_UNITS[told]
    different = np.unique(times)
    whole = bool((different == np.floor(different)).all()) and len(different) > 2
    decimals = _decimals(table, cells)
    if whole and not (bracket or minutes) and (fps is not None or decimals == 0):
        if fps is None:
            raise InputError(
                f"{table.path}: the times are whole numbers: frames? give their rate (`fps`), or"
                " 1 for seconds; for milliseconds name the column t (ms)"
            )
        return times / fps, None, [f"{table.path}: the times are whole numbers; read as frames"]
    warnings: list[str] = []
    if fps is not None:
        warnings.append(f"{table.path}: has times of its own; the given frame rate is not used")
    return times * unit, decimals if unit == 1.0 else None, warnings


def _decimals(table: TextTable, written: list[str]) -> int | None:
    """How many decimals cells are printed to; None where an exponent leaves it open."""
    (cells,) = plain_decimals([written], str(table.path))
    if any("E" in cell or "e" in cell for cell in cells):
        return None
    return max((len(cell.partition(".")[2]) for cell in cells), default=None)


def refuse_disorder(table: TextTable, times: Array) -> None:
    """Raise `InputError` where times are missing, absurd, or do not increase from row to row."""
    if not np.isfinite(times).all():
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        raise InputError(f"{table.path}: line {table.line_numbers[row]}: no time")
    if np.abs(times).max() > LATEST:
        raise InputError(f"{table.path}: times up to {np.abs(times).max():g} s make no sense")
    steps = np.diff(times)
    if (steps <= 0).any():
        row = int(np.flatnonzero(steps <= 0)[0])
        how = "goes back" if steps[row] < 0 else "stands still"
        raise InputError(
            f"{table.path}: line {table.line_numbers[row + 1]}: time {how} (from {times[row]:g} s"
            f" to {times[row + 1]:g} s); one row per time, please, or the names in a column stone"
        )


def values_of(table: TextTable, columns: Iterable[int], clock: int | None) -> dict[int, Array]:
    """Numbers of some columns and the times, by column; read at once, for one decimal sign."""
    wanted = sorted({*columns} if clock is None else {*columns, clock})
    return dict(zip(wanted, table.numbers(wanted, clock).T, strict=True))
