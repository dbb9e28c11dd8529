"""Where a path stops being one motion: the breaks of a single stone's way.

A free stone on ice is slowed for a while as a power of its speed. `breaks` finds the times at
which a path stops being such a motion: a push, a wall, a stop, a change of the ice.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import PLACE_MEMORY
from curlshot.physics.local_fit.segment_merging import (
    ACCELERATION_SD,
    OUTLIER,
    SPEED_SD,
    merge_segments,
)
from curlshot.physics.local_fit.traces import LASTING

Floats = NDArray[np.float64]

BREAK_COST = 12.0
"""Cost of a break in units of −2 log likelihood: one change in some hundred samples."""

FEWEST = 4
"""Detections that make a segment; fewer are taken for outliers."""

PRUNED_FROM, PRUNED_AFTER = 40.0, 8
"""Cost above that of the cheapest partition, some three breaks, from which a segment is pruned, and
how many detections it has before it may be."""

PRUNED_EACH = 4
"""They are pruned at one detection in so many: more often takes longer than to go on with them."""

STILL = 25.0
"""Squared normalised shift of a mean place, two axes, below which it is no trace of a motion."""

PLACE = 0.002
"""Places that are all this near to their median, m, are one, whatever their errors: those of a
camera that wanders are alike in all frames."""

ALIKE = 1.25
"""Share of a place's variance by which the errors of neighbouring frames are alike."""


def breaks(t: Floats, xy: Floats, sd: Floats, lasting: float = LASTING) -> list[float]:
    """Find the times at which a path stops being one glide.

    The partition with the highest marginal likelihood, found exactly by pruned dynamic
    programming (Killick et al., 2012, J. Am. Stat. Assoc. 107, 1590), the likelihood of each
    segment coming from a recursive least-squares filter of place, velocity and acceleration. Of
    the breaks that white errors leave those are kept that neither lasting errors explain nor one
    glide that slows the more the slower it is (`curlshot.physics.local_fit.segment_merging`).

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
    if n < FEWEST + 2 or _at_one_place(xy, white):
        return ()
    sought = _starts(t, xy, white, np.ones(n, bool))
    if not sought:
        return ()
    # As often as detections err alike they say the same once more: only what stands out of that is
    # a break. Where it is, their scatter tells best.
    alike = 2 * PLACE_MEMORY / float(np.median(np.diff(t)))
    held = (1 + max(ALIKE, lasting * alike)) * variance
    starts = _starts(t, xy, held, np.isin(np.arange(n), sought))
    starts = merge_segments(t, xy, held, starts, BREAK_COST)
    return tuple(0.5 * float(t[j - 1] + t[j]) for j in starts)


def _starts(t: Floats, xy: Floats, variance: Floats, may: NDArray[np.bool_]) -> list[int]:
    """Find the samples, of those that may, at which all segments but the first begin."""
    n, count = len(t), 0
    best = np.full(n + 1, np.inf)
    best[0] = -BREAK_COST
    origin = np.zeros(n + 1, dtype=int)
    # By segment that is tried: where it begins, its cost, powers of the time since then, and of
    # place, velocity and acceleration the mean (two axes) and the covariance, side by side.
    starts, cost = np.empty(n, dtype=int), np.empty(n)
    since, state = np.ones((3, n)), np.empty((3, 5, n))
    unknown = np.zeros((3, 5))
    unknown[[1, 2], [3, 4]] = SPEED_SD**2, ACCELERATION_SD**2
    for j in range(n):
        now, powers, noise = state[..., :count], since[:, :count], variance[j]
        np.subtract(t[j], t[starts[:count]], out=powers[1])
        np.multiply(powers[1], 0.5 * powers[1], out=powers[2])
        beyond = (now * powers[:, None]).sum(0)
        beyond[:2] -= xy[j, :, None]
        away, gain = beyond[:2], beyond[2:]
        # Over minutes without a row what is known of a path may round to less than nothing.
        total = np.maximum((gain * powers).sum(0), 0.0) + noise
        distance = (away * away).sum(0) / total
        ok = distance < OUTLIER
        cost[:count] += np.where(ok, distance + 2 * np.log(total / noise), OUTLIER)
        now -= (gain * np.where(ok, 1.0 / total, 0.0))[:, None] * beyond
        if may[j] or not j:
            # A segment that begins here knows its place and nothing of its motion.
            unknown[0, :3] = *xy[j], noise
            starts[count], cost[count], state[..., count] = j, best[j] + BREAK_COST, unknown
            count += 1
        pick = int(cost[:count].argmin())
        best[j + 1], origin[j + 1] = cost[pick], starts[pick]
        if j % PRUNED_EACH:
            continue
        keep = cost[:count] < best[j + 1] + PRUNED_FROM
        left = np.flatnonzero(keep | (starts[:count] > j - PRUNED_AFTER))
        if len(left) < count:
            count = len(left)
            starts[:count], cost[:count] = starts[left], cost[left]
            state[..., :count] = state[..., left]
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
    `FEWEST` detections and of twice, four times … as many.
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
