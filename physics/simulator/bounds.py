"""Where stones are in play, and when they leave it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import SHEET
from curlshot.physics.simulator.approach import SHORTEST
from curlshot.physics.simulator.motion import Path, Point

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class Bounds:
    """The part of a sheet in which stones are in play.

    A stone is out where it touches a side line, where it is wholly past the back line, and
    where it stops short of the hog line without having hit another (The Rules of Curling and
    Rules of Competition, World Curling, 2023, R3 and R5). Stones that lie still are left alone.

    Attributes
    ----------
    play : int
        +1 where stones are thrown up y, -1 where they are thrown down.
    half_width, back_line, hog_line : float
        Distances of the lines from the tee, m.

    Examples
    --------
    >>> import curlshot
    >>> float(curlshot.Bounds(play=-1).beyond(0.0, 0.0, 0.1455)) < 0
    True
    """

    play: int = 1
    half_width: float = SHEET.half_width
    back_line: float = SHEET.back_line
    hog_line: float = SHEET.hog_line

    def beyond(self, x: ArrayLike, y: ArrayLike, radius: float) -> Array:
        """How far stones are out over the side lines or the back line, m; negative within."""
        side = np.abs(x) + radius - self.half_width
        return np.maximum(side, self.play * np.asarray(y, float) - radius - self.back_line)

    def short(self, y: ArrayLike, radius: float) -> NDArray[np.bool_]:
        """Whether stones that stop there have not cleared the hog line."""
        return np.asarray(self.play * np.asarray(y, float) - radius < -self.hog_line)


def leaves_at(path: Path, bounds: Bounds, radius: float, *, hit: bool) -> float:
    """Time at which a stone on its path leaves the play, infinity where it does not.

    Parameters
    ----------
    path : Path
        The stone's way if nothing hits it.
    bounds : Bounds
        Where it is in play.
    radius : float
        Of the stone, m.
    hit : bool
        Whether it has hit another.
    """
    if path.length == 0:
        return math.inf
    t0, p0 = path.start, path.point(path.start)
    later = [(path.stop, path.end)]
    while later:
        t1, p1 = later[-1]
        inside = max(_beyond(bounds, p0, radius), _beyond(bounds, p1, radius)) < -_bow(p0, p1)
        if not inside and t1 - t0 > SHORTEST:
            middle = t0 + (t1 - t0) / 2
            later.append((middle, path.point(middle)))
            continue
        if not inside and _beyond(bounds, p1, radius) >= 0:
            return t1
        t0, p0 = later.pop()
    return path.stop if not hit and bounds.short(path.end.y, radius) else math.inf


def _beyond(bounds: Bounds, point: Point, radius: float) -> float:
    return max(
        abs(point.x) + radius - bounds.half_width,
        bounds.play * point.y - radius - bounds.back_line,
    )


def _bow(p0: Point, p1: Point) -> float:
    """Bound on how far a path leaves the chord between two of its points, m."""
    turn = abs(p1.heading - p0.heading)
    return math.hypot(p1.x - p0.x, p1.y - p0.y) / 2 * math.tan(turn / 2) if turn < 2 else math.inf


def all_leave_at(
    points: Callable[[Index, Array], Array],
    which: Index,
    start: Array,
    stop: Array,
    bounds: Bounds,
    radius: float,
    hit: NDArray[np.bool_],
) -> Array:
    """Do what `leaves_at` does for many paths at once.

    Parameters
    ----------
    points : callable
        From ranks of paths and times to places, speeds and directions, shape (n, 4).
    which : ndarray of int, shape (n,)
        Ranks of the paths.
    start, stop : ndarray, shape (n,)
        Times at which they begin and at which the stones stop, s.
    bounds, radius
        As of `leaves_at`.
    hit : ndarray of bool, shape (n,)
        Whether the stones have hit another.
    """
    first, last = points(which, start), points(which, stop)
    out = np.where(~hit & bounds.short(last[:, 1], radius), stop, np.inf)
    out[stop <= start] = np.inf
    lanes = np.flatnonzero((stop > start) & ~_inside(bounds, first, last, radius))
    t, step, now = start[lanes].copy(), (stop - start)[lanes] / 2, first[lanes]
    while lanes.size:
        then = np.minimum(t + step, stop[lanes])
        there = points(which[lanes], then)
        clear = _inside(bounds, now, there, radius)
        found = ~clear & (then - t <= SHORTEST)
        gone = found & (bounds.beyond(there[:, 0], there[:, 1], radius) >= 0)
        out[lanes[gone]] = then[gone]
        passed = clear | found
        t, now = np.where(passed, then, t), np.where(passed[:, None], there, now)
        step = np.where(passed, 2 * step, step / 2)
        on = ~gone & (t < stop[lanes])
        lanes, t, step, now = lanes[on], t[on], step[on], now[on]
    return out


def _inside(bounds: Bounds, p0: Array, p1: Array, radius: float) -> NDArray[np.bool_]:
    """Whether paths stay in play between two of their points for certain."""
    turn = np.abs(p1[:, 3] - p0[:, 3])
    chord = np.hypot(p1[:, 0] - p0[:, 0], p1[:, 1] - p0[:, 1])
    bow = np.where(turn < 2, chord / 2 * np.tan(np.minimum(turn, 2.0) / 2), np.inf)
    ends = [bounds.beyond(p[:, 0], p[:, 1], radius) for p in (p0, p1)]
    return np.asarray(np.maximum(*ends) < -bow)
