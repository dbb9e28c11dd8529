"""Angle tracks: how a stone is turned, from an export of a point of its edge about its centre.

With the origin in the stone's centre, Tracker's θ of a point of the edge is the stone's own
angle. Its exports do not say whether θ is in degrees or radians: here the point's x and y tell,
else where θ begins (Tracker begins within half a turn), else how fast it changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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
from curlshot.data.headers import plain_name
from curlshot.data.units import ANGLE_UNITS

Array = NDArray[np.float64]

FASTEST_SPIN = 20.0
"""rad/s; three turns a second. Faster angles without a unit are taken as degrees."""

_DOUBTFUL_SPIN = 5.0
"""rad/s; radians of a stone hit hard, and degrees of one that hardly turns."""

_ROUNDED = 0.01
"""rad; what a printed angle may be beyond half a turn."""

_NEARLY_ALL = (0.05, 0.95)
"""Quantiles; a slipped mark or two do not count."""

_WANDERS = 2.0
"""How many times nearer and farther marks may be; those of an edge stay within tenths, a stone
that goes across the house is many times nearer to the tee and farther from it."""

_CONTINUOUS = ("θ", "theta", "angle", "ang")
_WRAPPED = ("θr",)


@dataclass(frozen=True)
class AngleTrack:
    """A stone's angle over time.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Increasing times, s.
    theta : ndarray, shape (n,)
        Continuous angle, radians, counter-clockwise; its zero is arbitrary.
    warnings : tuple of str
        What was decided on evidence.
    """

    t: Array
    theta: Array
    warnings: tuple[str, ...] = ()


def read_angles(path: Path, angle_unit: str | None = None, fps: float | None = None) -> AngleTrack:
    """Read the angle of one stone from a text export.

    Parameters
    ----------
    path : Path
        A table with t and θ, or t, x and y of a point of the edge about the centre, or both.
    angle_unit : {"rad", "deg"}, optional
        Unit of θ where the file does not show it.
    fps : float, optional
        Rate of the rows where the file has no times, 1/s.

    Raises
    ------
    InputError
        One line: no angle, several tracks, or a unit that cannot be told.
    """
    table = read_text_table(path, _is_header, "angles: no header with t and θ")
    if not table.rows:
        raise InputError(f"{path}: a header without rows of data")
    names = _names(table)
    columns = {
        key: names.index(name)
        for key, options in (("θ", _CONTINUOUS), ("θr", _WRAPPED), ("x", ("x",)), ("y", ("y",)))
        for name in options
        if name in names
    }
    doubled = [name for name in names if name in (*_CONTINUOUS, *_WRAPPED, "x")]
    if "stone" in names or len(doubled) > len(set(doubled)):
        raise InputError(f"{path}: several tracks; an angle needs one export per stone")
    clock = clock_column(table, names, fps)
    values = values_of(table, columns.values(), clock)
    times, _, warnings = times_of(table, values, clock, fps)
    refuse_disorder(table, times)
    theta = values[columns["θ"]] if "θ" in columns else None
    if theta is None and "θr" in columns:
        theta = values[columns["θr"]]
    direction = None
    if "x" in columns and "y" in columns:
        x, y = values[columns["x"]], values[columns["y"]]
        _refuse_wandering(path, np.hypot(x, y))
        direction = np.arctan2(y, x)
    if theta is None:
        if direction is None:
            raise InputError(f"{path}: no angle: needs t and θ, or t, x and y about the centre")
        theta, unit, wrapped = direction, "rad", True
    else:
        said = written_unit(table, names, ("θ", "θr", *_CONTINUOUS), ANGLE_UNITS)
        said = said if said in ANGLE_UNITS else None
        unit, notes = _unit(path, times, theta, direction, said, angle_unit)
        warnings += notes
        wrapped = "θ" not in columns
    known = np.isfinite(theta)
    if not known.any():
        raise InputError(f"{path}: no row with an angle")
    turned = theta[known] * ANGLE_UNITS[unit]
    if wrapped or np.ptp(turned) <= 2 * np.pi + 1e-6:
        turned = np.unwrap(turned)
    return AngleTrack(times[known], turned, tuple(warnings))


def attach(
    detections: pd.DataFrame, stone: str, track: AngleTrack, source: str
) -> tuple[pd.DataFrame, list[str]]:
    """Give a stone's detections the angles of the same times.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    stone : str
        Whose angle it is.
    track : AngleTrack
        The angle.
    source : str
        What to call the angle's file in messages.

    Returns
    -------
    detections : DataFrame
        With `theta` of the stone; NaN at times without an angle.
    warnings : list of str
        How many angles found no detection.

    Raises
    ------
    InputError
        No such stone, or no common time.
    """
    mine = (detections["stone"] == stone).to_numpy()
    if not mine.any():
        there = ", ".join(detections["stone"].unique())
        raise InputError(f"{source}: angle of {stone}: no such stone; there are {there}")
    times = detections.loc[mine, "t"].to_numpy(float)
    steps = np.concatenate([np.diff(times), np.diff(track.t)])
    # The same moment may be printed to another digit, but not be a quarter of a step away.
    tolerance = 0.25 * float(steps.min()) if len(steps) else 1e-3
    after = np.clip(np.searchsorted(track.t, times), 1, max(len(track.t) - 1, 1))
    nearest = np.minimum(after, len(track.t) - 1)
    before = after - 1
    nearer = np.abs(track.t[before] - times) <= np.abs(track.t[nearest] - times)
    nearest = np.where(nearer, before, nearest)
    same = np.abs(track.t[nearest] - times) <= tolerance
    if not same.any():
        raise InputError(
            f"{source}: angle of {stone}: none of its times ({track.t[0]:.3g} to"
            f" {track.t[-1]:.3g} s) is a time of {stone} ({times[0]:.3g} to {times[-1]:.3g} s)"
        )
    theta = detections["theta"].to_numpy(float).copy()
    theta[mine] = np.where(same, track.theta[nearest], np.nan)
    lost = len(track.t) - len(np.unique(nearest[same]))
    warnings = []
    if lost:
        warnings.append(f"{source}: {lost} of {len(track.t)} angles have no place of {stone}")
    return detections.assign(theta=theta), warnings


def spin_rate(t: Array, theta: Array) -> float:
    """Typical rate of change of an angle, per s; the median lets the jumps of a wrap pass."""
    if len(t) < 3:
        return 0.0
    with np.errstate(all="ignore"):
        return float(np.median(np.abs(np.diff(theta) / np.diff(t))))


def _is_header(cells: Sequence[str]) -> bool:
    names = [plain_name(cell) for cell in cells]
    if not names[0]:
        return False
    if names[0] in ("t", "time") or {"stone", "t"} <= set(names):  # a track may be named stone
        return True
    return any(name in (*_CONTINUOUS, *_WRAPPED) for name in names)


def _names(table: TextTable) -> list[str]:
    """Names of the columns; without a header two are t and θ."""
    if table.names is not None:
        return [plain_name(name) for name in table.names]
    if table.width == 2:
        return ["t", "θ"]
    if table.width == 3:
        return ["t", "x", "y"]
    raise InputError(f"{table.path}: {table.width} columns without a header; needs t and θ")


def _refuse_wandering(path: Path, distance: Array) -> None:
    """Refuse a point that does not stay as far from the origin as one of a stone's edge."""
    known = distance[np.isfinite(distance)]
    near, far = np.quantile(known, _NEARLY_ALL) if len(known) else (0.0, 0.0)
    if far > _WANDERS * near:
        raise InputError(
            f"{path}: the point is {near:.3g} to {far:.3g} from the origin, so it is not on the"
            " edge of a stone; put the origin into the centre of the stone (Coordinate System >"
            " Reference Frame)"
        )


def _unit(
    path: Path,
    t: Array,
    theta: Array,
    direction: Array | None,
    said: str | None,
    angle_unit: str | None,
) -> tuple[str, list[str]]:
    """Find the unit of θ by evidence, before what a person says, and a warning where it is thin."""
    known = np.isfinite(theta)
    shown = said or (None if direction is None else _unit_by_place(theta, direction))
    start = theta[known][:1]
    if shown is None and len(start) and abs(start[0]) > np.pi + _ROUNDED:
        shown = "deg"
    if shown is not None:
        other = angle_unit is not None and angle_unit != shown
        note = f"{path}: the file gives angles in {shown}, not in {angle_unit}"
        return shown, [note] if other else []
    if angle_unit is not None:
        return angle_unit, []
    rate = spin_rate(t[known], theta[known])
    if rate > FASTEST_SPIN:
        return "deg", [
            f"{path}: angles read in degrees, since they change too fast for radians"
            " (`angle_unit` overrides this)"
        ]
    if rate > _DOUBTFUL_SPIN:
        raise InputError(
            f"{path}: angles in degrees or in radians? they change by {rate:.0f} a second; give"
            " `angle_unit`, or export x and y too"
        )
    return "rad", [f"{path}: angles read in radians (`angle_unit` overrides this)"]


def _unit_by_place(theta: Array, direction: Array) -> str | None:
    """Tell in which unit an angle is the direction of x and y; None if in neither, or both."""
    known = np.isfinite(theta) & np.isfinite(direction)
    if not known.any():
        return None
    off = {
        unit: float(np.median(np.abs(np.angle(np.exp(1j * (theta * size - direction)[known])))))
        for unit, size in ANGLE_UNITS.items()
    }
    best = min(off, key=lambda unit: off[unit])
    return best if off[best] < 0.02 and max(off.values()) > 0.1 else None
