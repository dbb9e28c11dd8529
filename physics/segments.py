"""Where a motion of one kind ends: the paths of single stones cut into pieces.

A free stone on ice moves for a while with nearly constant acceleration. `breaks` finds the
times at which a path stops being such a motion: a push, a wall, a stop, a change of the ice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physics.stretch import PLACE_MEMORY
from physics.traces import LASTING, Trace

Floats = NDArray[np.float64]

SPEED_SD, ACCELERATION_SD = 3.0, 0.5
"""Prior of a segment's velocity (m/s) and acceleration (m/s²) when looking for breaks."""

BREAK_COST = 12.0
"""Cost of a break in units of −2 log likelihood: one change in some hundred samples."""

FEWEST = 4
"""Sightings that make a segment; fewer are taken for outliers."""

STILL = 25.0
"""Squared normalised shift of a mean place, two axes, below which it is no trace of a motion."""

PLACE = 0.002
"""Places that are all this near to their median, m, are one, whatever their errors: those of a
camera that wanders are alike in all frames."""

ALIKE = 1.25
"""Share of a place's variance by which the errors of neighbouring frames are alike."""

OUTLIER = 16.0
"""Squared normalised error, two axes, at which a sample costs no more."""


def breaks(t: Floats, xy: Floats, sd: Floats, lasting: float = LASTING) -> list[float]:
    """Find the times at which a path stops being one motion of constant acceleration.

    The partition with the highest marginal likelihood, found exactly by pruned dynamic
    programming (Killick et al., 2012, J. Am. Stat. Assoc. 107, 1590), the likelihood of each
    segment coming from a recursive least-squares filter of place, velocity and acceleration. Of
    the breaks that white errors leave those are kept that lasting errors do not explain.

    Parameters
    ----------
    t, xy, sd : (n,), (n, 2), (n, 2) arrays
        Times, places and their standard deviations.
    lasting : float
        Share of the places' variance by which those within `PLACE_MEMORY` err alike.

    Returns
    -------
    list of float
        Times between the last sample of one segment and the first of the next, s.
    """
    # The same paths are asked for again: for hits, for what moves, for the filter.
    return list(_breaks(np.column_stack([t, xy, sd]).tobytes(), lasting))


@lru_cache(maxsize=64)
def _breaks(samples: bytes, lasting: float) -> tuple[float, ...]:
    """As `breaks`, of rows of time, place and standard deviations."""
    t, xy, sd = np.split(np.frombuffer(samples).reshape(-1, 5), [1, 3], axis=1)
    t, n = t[:, 0], len(t)
    variance = np.mean(sd**2, axis=1)
    white = (1 + ALIKE) * variance
    if n < 6 or _at_one_place(xy, white):
        return ()
    sought = _starts(t, xy, white, np.ones(n, bool))
    if not sought:
        return ()
    # As often as sightings err alike they say the same once more: only what stands out of that is
    # a break. Where it is, their scatter tells best.
    alike = 2 * PLACE_MEMORY / float(np.median(np.diff(t)))
    held = (1 + max(ALIKE, lasting * alike)) * variance
    starts = _starts(t, xy, held, np.isin(np.arange(n), sought))
    return tuple(0.5 * float(t[j - 1] + t[j]) for j in starts)


def _starts(t: Floats, xy: Floats, variance: Floats, may: NDArray[np.bool_]) -> list[int]:
    """Find the samples, of those that may, at which all segments but the first begin."""
    n = len(t)
    best = np.full(n + 1, np.inf)
    best[0] = -BREAK_COST
    origin = np.zeros(n + 1, dtype=int)
    starts, cost = np.empty(0, dtype=int), np.empty(0)
    # Mean (two axes) and covariance of place, velocity and acceleration, side by side.
    state = np.empty((0, 3, 5))
    for j in range(n):
        tau = t[j] - t[starts]
        phi = np.stack([np.ones_like(tau), tau, 0.5 * tau * tau], axis=1)
        expected = (phi[:, None] @ state)[:, 0]
        error, gain = xy[j] - expected[:, :2], expected[:, 2:]
        total = (gain * phi) @ np.ones(3) + variance[j]
        distance = (error * error) @ np.ones(2) / total
        ok = distance < OUTLIER
        cost = cost + np.where(ok, distance + 2 * np.log(total / variance[j]), OUTLIER)
        share = np.where(ok, 1.0 / total, 0.0)[:, None]
        state += (gain * share)[:, :, None] * np.concatenate([error, -gain], axis=1)[:, None]
        if may[j] or not j:
            # A segment that begins here knows its place and nothing of its motion.
            first = np.zeros((1, 3, 5))
            first[0, 0, :2] = xy[j]
            first[0, :, 2:] = np.diag([variance[j], SPEED_SD**2, ACCELERATION_SD**2])
            starts = np.append(starts, j)
            cost = np.append(cost, best[j] + BREAK_COST)
            state = np.concatenate([state, first])
        pick = int(cost.argmin())
        best[j + 1], origin[j + 1] = cost[pick], starts[pick]
        keep = (cost < best[j + 1] + 40.0) | (starts > j - 8)
        if not keep.all():
            starts, cost, state = starts[keep], cost[keep], state[keep]
    found: list[int] = []
    j = int(origin[n])
    while j > 0:
        found.append(j)
        j = int(origin[j])
    return found[::-1]


def _at_one_place(xy: Floats, variance: Floats) -> bool:
    """Whether places show no trace of a motion, over the whole or over any shorter stretch.

    Most stones rest most of the time, and to see that is a thousand times cheaper than to
    look for breaks. A break would show in the mean place over one of the stretches of
    `FEWEST` sightings and of twice, four times … as many.
    """
    if np.abs(xy - np.median(xy, axis=0)).max() < PLACE:
        return True
    weights = 1 / variance
    total = np.concatenate([[0.0], np.cumsum(weights)])
    centre = weights @ xy / total[-1]
    sums = np.concatenate([np.zeros((1, 2)), np.cumsum(weights[:, None] * (xy - centre), axis=0)])
    length = FEWEST
    while length <= len(xy):
        step = max(length // 2, 1)
        shift = np.sum((sums[length::step] - sums[:-length:step]) ** 2, axis=1)
        if np.any(shift > STILL * (total[length::step] - total[:-length:step])):
            return False
        length *= 2
    return True


@dataclass(frozen=True)
class Piece:
    """A stretch of one stone's path without a hit: the unit of all fits.

    Attributes
    ----------
    stone : str
        Whose path.
    start, end : float
        Times that bound it, s (infinite at the ends of a path).
    samples : (n,) int array
        Which of the path's sightings lie in it.
    rest : bool
        The stone lies still throughout.
    stops : bool
        The stone comes to rest within it.
    opens, closes : int or None
        Rank of the hit that begins and of the one that ends it.
    """

    stone: str
    start: float
    end: float
    samples: NDArray[Any]
    rest: bool = False
    stops: bool = False
    opens: int | None = None
    closes: int | None = None


@dataclass(frozen=True)
class _Motion:
    """Mean velocity of a stretch, its error, and the velocity at its end."""

    velocity: Floats
    stderr: float
    last: Floats


def cut(path: Trace, hits: Sequence[tuple[int, float]], radius: float) -> list[Piece]:
    """Cut a path at its hits, and between them where its motion changes of itself.

    Parameters
    ----------
    path : Trace
        One stone's.
    hits : sequence of (rank, time)
        The stone's hits in order of time.
    radius : float
        Of the discs, m: sets what counts as lying still.
    """
    bounds = [-np.inf, *(time for _, time in hits), np.inf]
    ranks: list[int | None] = [None, *(rank for rank, _ in hits), None]
    pieces: list[Piece] = []
    for k in range(len(bounds) - 1):
        inside = np.flatnonzero(path.between(bounds[k], bounds[k + 1]))
        # A frame beside a hit may belong to its other side: it has no say in where breaks are.
        margin = 0.6 * path.step
        sure = inside[
            (path.t[inside] > bounds[k] + margin) & (path.t[inside] < bounds[k + 1] - margin)
        ]
        edges = breaks(path.t[sure], path.xy[sure], path.sd[sure], path.lasting)
        cuts = [bounds[k], *_spaced(edges, path.t[inside]), bounds[k + 1]]
        run: list[Piece] = []
        for i in range(len(cuts) - 1):
            samples = inside[(path.t[inside] >= cuts[i]) & (path.t[inside] < cuts[i + 1])]
            opens = ranks[k] if i == 0 else None
            closes = ranks[k + 1] if i == len(cuts) - 2 else None
            run.append(_piece(path, cuts[i], cuts[i + 1], samples, opens, closes, radius))
        pieces += _with_stops(path, run, radius)
    return pieces


def _spaced(edges: Sequence[float], t: Floats) -> list[float]:
    """Keep the breaks that leave at least `FEWEST` sightings on either side of them."""
    kept: list[float] = []
    passed = 0
    for edge in edges:
        k = int(np.searchsorted(t, edge))
        if k - passed >= FEWEST and len(t) - k >= FEWEST:
            kept.append(edge)
            passed = k
    return kept


def _motion(path: Trace, samples: NDArray[Any]) -> _Motion:
    """Fit a line (two or three samples) or a parabola to a stretch."""
    t = path.t[samples]
    if len(t) < 2:
        return _Motion(np.zeros(2), np.inf, np.zeros(2))
    tau = t - t.mean()
    sd = float(np.mean(path.sd[samples]))
    slope = tau @ path.xy[samples] / (tau @ tau)
    last = slope
    if len(t) >= 6:
        coefficients = np.polynomial.polynomial.polyfit(tau / tau[-1], path.xy[samples], 2)
        last = (coefficients[1] + 2 * coefficients[2]) / tau[-1]
    return _Motion(slope, sd / float(np.sqrt(tau @ tau)), last)


def _piece(
    path: Trace,
    start: float,
    end: float,
    samples: NDArray[Any],
    opens: int | None,
    closes: int | None,
    radius: float,
) -> Piece:
    motion = _motion(path, samples)
    slow = 0.15 * radius
    speed = float(np.hypot(*motion.velocity))
    if opens is None:
        rest = speed < slow + 2 * min(motion.stderr, 1e3)
        if len(samples) < 2:
            rest = True
    else:
        # Who was hit moves, unless a long look says otherwise.
        rest = False
    return Piece(path.stone, start, end, samples, rest, False, opens, closes)


def _with_stops(path: Trace, run: list[Piece], radius: float) -> list[Piece]:
    """Join a glide and the rest that it ends in; join rests that follow each other."""
    out: list[Piece] = []
    for piece in run:
        # A rest that a hit ends stays by itself: the hit must find its stone lying still.
        if out and piece.rest and (piece.closes is None or out[-1].rest):
            last = out[-1]
            slow_end = last.rest or last.stops
            if not slow_end:
                motion = _motion(path, last.samples)
                slow_end = float(np.hypot(*motion.last)) < 0.15 * radius + 0.12 + 3 * motion.stderr
            if slow_end:
                samples = np.concatenate([last.samples, piece.samples])
                out[-1] = replace(
                    last, end=piece.end, samples=samples, stops=not last.rest, closes=piece.closes
                )
                continue
        out.append(piece)
    return out
