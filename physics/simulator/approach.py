"""When two stones meet: the first moment at which two paths are within a distance.

Over an interval of time both paths are bounded by their ends. An interval over which they stay
apart for certain is passed over as a whole; others are split, the earlier part first, so that
no contact is missed however short it is. They are split where stones that kept their
velocities would meet, which is nearly where these do.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from curlshot.data.geometry import origin_to_segment

if TYPE_CHECKING:
    from curlshot.physics.simulator.motion import Path, Point

Array = NDArray[np.float64]
Index = NDArray[np.intp]

BEYOND = 1.02
"""Share of the time to a contact, were velocities kept, after which to look: stones are slowed."""
SHORTEST = 1e-9
"""Interval of time to which a crossing is found, and over which a graze counts as none, s."""


def first_contact(
    a: Path,
    b: Path,
    start: float,
    places: tuple[Point, Point],
    reach: float,
    until: float = math.inf,
) -> float:
    """First time after `start` at which two paths are within `reach`, inf where not by `until`.

    A time before `until` is the same, to the last bit, whenever the search is to end.

    Parameters
    ----------
    a, b : Path
        Paths of two stones that are farther apart than `reach` at the start.
    start : float
        Time at which to begin, s.
    places : tuple of two Point
        Where they are then.
    reach : float
        Distance of their centres, m.
    until : float, optional
        Time at which to end, s: on hardly any friction stones glide for an hour, in spirals.
    """
    end = max(a.stop, b.stop)
    if end <= start:
        return math.inf
    later = [(end, a.point(end), b.point(end))]
    t0, a0, b0 = start, *places
    while later and t0 < until:
        t1, a1, b1 = later[-1]
        step = t1 - t0
        if _part(a0, a1, b0, b1):
            t0, a0, b0 = later.pop()
            continue
        slack = _slack(a0, a1, b0, b1, step)
        x0, y0, x1, y1 = b0.x - a0.x, b0.y - a0.y, b1.x - a1.x, b1.y - a1.y
        if origin_to_segment(x0, y0, x1, y1) - slack > reach:
            t0, a0, b0 = later.pop()
            continue
        if slack < 1e-3 * reach and math.hypot(x1, y1) <= reach:
            return _crossing(a, b, t0, t1, reach)
        middle, split = t0 + step / 2, t0 + BEYOND * _ahead(a0, b0, reach)
        if step < SHORTEST or not t0 < middle < t1:
            # They graze, closer than numbers can tell.
            t0, a0, b0 = later.pop()
            continue
        # Stones abreast that come nearer by rounding alone do so for no time at all.
        if not t0 + SHORTEST < split < middle:
            split = middle
        later.append((split, a.point(split), b.point(split)))
    return math.inf


def _slack(a0: Point, a1: Point, b0: Point, b1: Point, step: float) -> float:
    """Bound on how far two stones can be from where their chords say, m.

    A path turns one way by |Δφ|, so it leaves its chord of length c by c/2 tan(|Δφ|/2) at
    most: that is all that counts if the other stone rests. If both move their places along
    the chords count too: the velocity stays within a set of the diameter
    D = v0 - v1 + v0 |Δφ|, as the speed only falls, and so the place within h D / 4 of a point
    that runs along the chord evenly in the time h.
    """
    if a0.speed == 0 or b0.speed == 0:
        p0, p1 = (b0, b1) if a0.speed == 0 else (a0, a1)
        turn = abs(p1.heading - p0.heading)
        if turn < 1:
            return math.hypot(p1.x - p0.x, p1.y - p0.y) / 2 * math.tan(turn / 2)
    return step / 4 * (_spread(a0, a1) + _spread(b0, b1))


def _spread(p0: Point, p1: Point) -> float:
    """Bound on the diameter of the set of velocities between two points of a path."""
    return p0.speed - p1.speed + p0.speed * abs(p1.heading - p0.heading)


def _part(a0: Point, a1: Point, b0: Point, b1: Point) -> bool:
    """Whether two stones only part between two moments, along the line between them at first.

    On one ice the faster of two stones stays the faster: the other need not be slow to be left
    behind.
    """
    line = math.atan2(b0.y - a0.y, b0.x - a0.x)
    least, most = _shares(b0, b1, line)[0], _shares(a0, a1, line)[1]
    if b0.speed >= a0.speed and least >= max(most, 0.0):
        return True
    if a0.speed >= b0.speed and most <= min(least, 0.0):
        return True
    slowest = least * (b0.speed if least < 0 else b1.speed)
    return slowest >= most * (a0.speed if most > 0 else a1.speed)


def _shares(p0: Point, p1: Point, line: float) -> tuple[float, float]:
    """Bounds on the part of a stone's speed that is along a line, between two points of a path."""
    one, other = math.cos(p0.heading - line), math.cos(p1.heading - line)
    # Between its ends the heading may come nearer to the line, or its opposite, than at both:
    # 1 - cos(Δ/2) is less than Δ²/8.
    turn = p1.heading - p0.heading
    bow = turn * turn / 8
    return (one - bow, other + bow) if one < other else (other - bow, one + bow)


def _ahead(a: Point, b: Point, reach: float) -> float:
    """Time until two stones that keep their velocities meet, or until they are nearest, s."""
    x, y = b.x - a.x, b.y - a.y
    vx = b.speed * math.cos(b.heading) - a.speed * math.cos(a.heading)
    vy = b.speed * math.sin(b.heading) - a.speed * math.sin(a.heading)
    closing, square = -(x * vx + y * vy), vx * vx + vy * vy
    if closing <= 0 or square == 0:
        return math.inf
    gap = x * x + y * y - reach * reach
    within = closing * closing - square * gap
    return gap / (closing + math.sqrt(within)) if within > 0 else closing / square


def _crossing(a: Path, b: Path, low: float, high: float, reach: float) -> float:
    """Time between `low` (apart) and `high` (within reach) at which the distance is `reach`."""
    t = high
    for _ in range(100):
        pa, pb = a.point(t), b.point(t)
        dx, dy = pb.x - pa.x, pb.y - pa.y
        distance = math.hypot(dx, dy)
        if distance > reach:
            low = t
        else:
            high = t
        vx = pb.speed * math.cos(pb.heading) - pa.speed * math.cos(pa.heading)
        vy = pb.speed * math.sin(pb.heading) - pa.speed * math.sin(pa.heading)
        rate = (vx * dx + vy * dy) / distance
        new = t - (distance - reach) / rate if rate < 0 else low
        if not low < new < high:
            new = (low + high) / 2
        if abs(new - t) <= 1e-13 * max(1.0, t):
            return new
        t = new
    return t


def all_nearest(start: Array, end: Array) -> Array:
    """Return distances of the origin from segments between offsets, shape (n,).

    The same for one segment is `curlshot.data.geometry.origin_to_segment`.
    """
    x, y = start[:, 0], start[:, 1]
    dx, dy = end[:, 0] - x, end[:, 1] - y
    square = dx * dx + dy * dy
    s = np.clip(-(x * dx + y * dy) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    return np.asarray(np.hypot(x + s * dx, y + s * dy))


def all_slack(a0: Array, a1: Array, b0: Array, b1: Array, step: Array) -> Array:
    """Bound on how far two stones can be from where their chords say, m.

    See `_slack`; here the first of the two moves.
    """
    turn = np.abs(a1[:, 3] - a0[:, 3])
    chord = np.hypot(a1[:, 0] - a0[:, 0], a1[:, 1] - a0[:, 1])
    alone = chord / 2 * np.tan(np.minimum(turn, 1.0) / 2)
    both = step / 4 * (_spreads(a0, a1) + _spreads(b0, b1))
    return np.where((b0[:, 2] == 0) & (turn < 1), alone, both)


def _spreads(p0: Array, p1: Array) -> Array:
    """Bounds on the diameters of the sets of velocities between two points of paths."""
    return np.asarray(p0[:, 2] - p1[:, 2] + p0[:, 2] * np.abs(p1[:, 3] - p0[:, 3]))


def all_crossings(
    points: Callable[[Index, Array], Array], a: Index, b: Index, low: Array, high: Array,
    reach: Array,
) -> Array:  # fmt: skip
    """Find when pairs meet between `low` (apart) and `high` (within reach); see `_crossing`.

    Parameters
    ----------
    points : callable
        From ranks of paths and times to places, speeds and directions, shape (n, 4).
    a, b : ndarray of int, shape (n,)
        Ranks of the paths of each pair.
    low, high : ndarray, shape (n,)
        Times, s.
    reach : ndarray, shape (n,)
        Distances of their centres, m.
    """
    low, high = low.copy(), high.copy()
    t = (low + high) / 2
    for _ in range(100):
        pa, pb = points(a, t), points(b, t)
        offset = pb[:, :2] - pa[:, :2]
        distance = np.hypot(offset[:, 0], offset[:, 1])
        low, high = np.where(distance > reach, t, low), np.where(distance > reach, high, t)
        rate = ((velocity(pb) - velocity(pa)) * offset).sum(axis=1) / distance
        new = np.where(rate < 0, t - (distance - reach) / np.where(rate < 0, rate, 1.0), low)
        # A step as short as this leaves no more than rounding; it may end on the bracket.
        done = np.abs(new - t) <= 1e-11 * np.maximum(1.0, t)
        t = np.where(done | ((low < new) & (new < high)), new, (low + high) / 2)
        if done.all():
            break
    return t


def velocity(points: Array) -> Array:
    """Velocities at points of paths, shape (..., 2), m/s."""
    speed, heading = points[..., 2], points[..., 3]
    return np.stack([speed * np.cos(heading), speed * np.sin(heading)], axis=-1)
