"""The paths of single stones cut into pieces: at hits, and where a motion of one kind ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.breaks import FEWEST, breaks
from curlshot.physics.local_fit.traces import Trace

Floats = NDArray[np.float64]

BESIDE = 0.6
"""Usual times between detections before or after a hit within which one may show its other side."""

SLOW = 0.15
"""Mean speed of a stone that is taken to rest, its radii per second: on ice it would stop within a
quarter of a second and three millimetres."""

SLOW_END = 0.12
"""How much faster a stone may be at the end of a glide that ends at rest, m/s: a second's glide on
ice, of which the last frames may be missing."""

SHORTLY = 2.0
"""Time at either end of a stretch, s, within which it shows whether a stone moves there: no share
of it, for a rest that follows may be a hundred times as long as the glide that ends in it."""

MOVED, NOISE, BETWEEN = 0.2, 5.0, 9
"""How far from where it lay a stone is that was moved, in radii, and in standard errors of its
places: a house that comes in smeared by a pan was 2 cm off. So many detections on either side tell
where it lies."""

CURVED = 6
"""Detections from which the speed at the end of a stretch is told by a parabola, not a line."""


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
        Which of the path's detections lie in it.
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
        margin = BESIDE * path.step
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
    """Keep the breaks that leave at least `FEWEST` detections on either side of them."""
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
    if len(t) >= CURVED:
        coefficients = np.polyfit(tau / tau[-1], path.xy[samples], 2)[::-1]
        last = (coefficients[1] + 2 * coefficients[2]) / tau[-1]
    return _Motion(slope, sd / float(np.sqrt(tau @ tau)), last)


def _speed(velocity: Floats) -> float:
    return float(np.hypot(*velocity))


def _piece(
    path: Trace,
    start: float,
    end: float,
    samples: NDArray[Any],
    opens: int | None,
    closes: int | None,
    radius: float,
) -> Piece:
    t = path.t[samples]
    early, late = samples[t <= t[:1] + SHORTLY], samples[t >= t[-1:] - SHORTLY]
    untold = len(samples) < 2 and closes is not None
    # Who was hit moves, and who hits it may.
    rest = opens is None and not untold and _slow(path, early, radius)
    stops = not rest and len(early) + len(late) <= len(samples) and _slow(path, late, radius)
    return Piece(path.stone, start, end, samples, rest, stops, opens, closes)


def _slow(path: Trace, samples: NDArray[Any], radius: float) -> bool:
    """Whether a stretch is as slow as one at rest, as far as noise tells."""
    motion = _motion(path, samples)
    return _speed(motion.velocity) < SLOW * radius + 2 * motion.stderr


def lies_still(path: Trace, before: Piece, after: Piece, radius: float) -> bool:
    """Whether a stone that rested lies where it lay, as far as noise tells: none may see it go."""
    last, first = before.samples[-BETWEEN:], after.samples[:BETWEEN]
    if not (len(last) and len(first)):
        return True
    away = np.median(path.xy[first], axis=0) - np.median(path.xy[last], axis=0)
    sd = np.hypot(path.sd, path.sd_place)
    noise = float(np.median(sd[np.concatenate([last, first])]))
    return _speed(away) < MOVED * radius + NOISE * noise


def _parted(path: Trace, before: Piece, after: Piece) -> tuple[Piece, Piece]:
    """Part two rests where a stone is no longer nearer to the first of them, but for strays."""
    samples = np.concatenate([before.samples, after.samples])
    there, here = (
        np.hypot(*(path.xy[samples] - np.median(path.xy[part], axis=0)).T)
        for part in (before.samples[-BETWEEN:], after.samples[:BETWEEN])
    )
    nearer = np.cumsum(np.where(there < here, 1, -1))[:-1]
    # Where a stray leaves two choices it was moved while nobody saw it for longer.
    k = int(np.where(nearer == nearer.max(), np.diff(path.t[samples]), 0.0).argmax()) + 1
    time = float(path.t[samples[k - 1 : k + 1]].mean())
    return (
        replace(before, end=time, samples=samples[:k]),
        replace(after, start=time, samples=samples[k:]),
    )


def _with_stops(path: Trace, run: list[Piece], radius: float) -> list[Piece]:
    """Join a glide and the rest that it ends in; join rests at one place, part those at two."""
    out: list[Piece] = []
    for piece in run:
        # A rest that a hit ends stays by itself: the hit must find its stone lying still.
        if out and piece.rest and (piece.closes is None or out[-1].rest):
            last = out[-1]
            if last.rest or last.stops:
                joins = lies_still(path, last, piece, radius)
            else:
                motion = _motion(path, last.samples)
                joins = _speed(motion.last) < SLOW * radius + SLOW_END + 3 * motion.stderr
            if joins:
                samples = np.concatenate([last.samples, piece.samples])
                out[-1] = replace(
                    last, end=piece.end, samples=samples, stops=not last.rest, closes=piece.closes
                )
                continue
            if last.rest:
                out[-1], piece = _parted(path, last, piece)
        out.append(piece)
    return out
