"""Where a motion of one kind ends: the paths of single stones cut into pieces.

A free stone on ice moves for a while with nearly constant acceleration. `breaks` finds the
times at which a path stops being such a motion: a push, a wall, a stop, a change of the ice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from physics.traces import Trace

Floats = NDArray[np.float64]

SPEED_SD, ACCELERATION_SD = 3.0, 0.5
"""Prior of a segment's velocity (m/s) and acceleration (m/s²) when looking for breaks."""

BREAK_COST = 12.0
"""Cost of a break in units of −2 log likelihood: one change in some hundred samples."""

FEWEST = 4
"""Sightings that make a segment; fewer are taken for outliers."""

OUTLIER = 16.0
"""Squared normalised error, two axes, at which a sample costs no more."""


def breaks(t: Floats, xy: Floats, sd: Floats) -> list[float]:
    """Find the times at which a path stops being one motion of constant acceleration.

    The partition with the highest marginal likelihood, found exactly by pruned dynamic
    programming (Killick et al., 2012, J. Am. Stat. Assoc. 107, 1590), the likelihood of each
    segment coming from a recursive least-squares filter of place, velocity and acceleration.

    Parameters
    ----------
    t, xy, sd : (n,), (n, 2), (n, 2) arrays
        Times, places and their standard deviations.

    Returns
    -------
    list of float
        Times between the last sample of one segment and the first of the next, s.
    """
    n = len(t)
    if n < 6:
        return []
    # Errors of neighbouring frames are alike; white noise of the same size would cry wolf.
    variance = (1.5**2) * np.mean(sd**2, axis=1)
    best = np.full(n + 1, np.inf)
    best[0] = -BREAK_COST
    origin = np.zeros(n + 1, dtype=int)
    starts = np.empty(0, dtype=int)
    cost = np.empty(0)
    mean = np.empty((0, 3, 2))
    spread = np.empty((0, 3, 3))
    for j in range(n):
        tau = t[j] - t[starts]
        phi = np.stack([np.ones_like(tau), tau, 0.5 * tau**2], axis=1)
        gain = np.einsum("kij,kj->ki", spread, phi)
        total = np.einsum("ki,ki->k", gain, phi) + variance[j]
        error = xy[j] - np.einsum("kia,ki->ka", mean, phi)
        distance = np.sum(error**2, axis=1) / total
        ok = distance < OUTLIER
        cost = cost + np.where(ok, distance + 2 * np.log(total / variance[j]), OUTLIER)
        share = np.where(ok, 1.0 / total, 0.0)
        mean = mean + np.einsum("ki,ka->kia", gain * share[:, None], error)
        spread = spread - np.einsum("ki,kj->kij", gain * share[:, None], gain)
        # A segment that begins here knows its place and nothing of its motion.
        starts = np.append(starts, j)
        cost = np.append(cost, best[j] + BREAK_COST)
        first = np.zeros((1, 3, 2))
        first[0, 0] = xy[j]
        mean = np.concatenate([mean, first])
        known = np.diag([variance[j], SPEED_SD**2, ACCELERATION_SD**2])
        spread = np.concatenate([spread, known[None]])
        pick = int(np.argmin(cost))
        best[j + 1], origin[j + 1] = cost[pick], starts[pick]
        keep = (cost < best[j + 1] + 40.0) | (starts > j - 8)
        starts, cost, mean, spread = starts[keep], cost[keep], mean[keep], spread[keep]
    found: list[float] = []
    j = int(origin[n])
    while j > 0:
        found.append(0.5 * float(t[j - 1] + t[j]))
        j = int(origin[j])
    return found[::-1]


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
        edges = breaks(path.t[sure], path.xy[sure], path.sd[sure]) if len(sure) else []
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
                out[-1] = Piece(
                    piece.stone,
                    last.start,
                    piece.end,
                    samples,
                    last.rest,
                    not last.rest,
                    last.opens,
                    piece.closes,
                )
                continue
        out.append(piece)
    return out
