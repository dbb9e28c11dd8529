"""Whether tracks can be those of discs of a radius: evidence of a wrong unit, radius or name."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.columns import UNIT_NOT_SAID
from curlshot.data.errors import InputError
from curlshot.data.sheet import curling_size

OVERLAP = 0.8
"""Share of their width to which centres may seem to come: nobody marks them exactly."""

OFTEN = 3
"""Times; what two discs do so often is no slip of one mark."""

FASTEST_STONE = 6.0
"""m/s; the hardest takeouts leave the hand at 4 to 5."""

WINDOW = 0.1
"""Seconds over which a speed is a mean: the noise of marks, a centimetre, hardly counts in it."""


def refuse_no_discs(
    detections: pd.DataFrame, radius: float, source: str, advice: str = UNIT_NOT_SAID
) -> None:
    """Refuse tracks that discs of this radius cannot have.

    Parameters
    ----------
    detections : DataFrame
        `curlshot.data.tracks.DETECTION_COLUMNS`.
    radius : float
        Of the discs, m.
    source : str
        What to call the tracks in messages.
    advice : str
        What may be wrong with the lengths.

    Raises
    ------
    InputError
        Two discs lie in one another at several times, or a curling stone is faster than any.
    """
    if curling_size(radius):
        _refuse_racing(detections, source, advice)
    places = detections.pivot_table(index="t", columns="stone", values=["x", "y"])
    for one, other in combinations(sorted(detections["stone"].unique()), 2):
        apart = np.hypot(
            places["x"][one] - places["x"][other], places["y"][one] - places["y"][other]
        )
        inside = apart[apart < OVERLAP * 2 * radius]
        if len(inside) >= OFTEN:
            raise InputError(
                f"{source}: {one} and {other} come within {_length(inside.min())} of each other"
                f" at t = {moment(inside.idxmin())}, but discs of radius {radius:g} m are"
                f" {_length(2 * radius)} wide: {advice}, another radius (`radius`), or one of them"
                " is not a stone (`names`)"
            )


def _refuse_racing(detections: pd.DataFrame, source: str, advice: str) -> None:
    for stone, rows in detections.groupby("stone", sort=False):
        speed, t = top_speed(rows["t"].to_numpy(), rows[["x", "y"]].to_numpy())
        if speed > FASTEST_STONE:
            raise InputError(
                f"{source}: {stone} moves at {speed:.1f} m/s at t = {moment(t)}, faster than any"
                f" curling stone: {advice}, a slipped mark, names exchanged, or other discs"
                " (`radius`)"
            )


def top_speed(t: NDArray[np.float64], xy: NDArray[np.float64]) -> tuple[float, float]:
    """Find the greatest mean speed over `WINDOW`, m/s, and the time at which it begins, s."""
    if len(t) < 2:
        return 0.0, float(t[0])
    ends = np.searchsorted(t, t + WINDOW * (1 - 1e-9))
    first = np.flatnonzero(ends < len(t))
    if len(first) == 0:
        first, ends = np.array([0]), np.array([len(t) - 1])
    last = ends[first] if len(ends) == len(t) else ends
    speeds = np.hypot(*(xy[last] - xy[first]).T) / (t[last] - t[first])
    top = int(np.argmax(speeds))
    return float(speeds[top]), float(t[first[top]])


def moment(t: float) -> str:
    """Write a time, s, to the millisecond: times that were rounded begin a little off zero."""
    return f"{round(t, 3) + 0.0:g} s"


def _length(metres: float) -> str:
    return f"{metres:.2f} m" if metres >= 1 else f"{100 * metres:.2g} cm"
