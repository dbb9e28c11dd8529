"""Hits that are expected: where stones go on from that meet while nobody sees them."""

from __future__ import annotations

from itertools import combinations
from math import dist

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOTION_TOLD = 3
"""Detections that tell how a stone moves, so that a hit nobody sees is expected."""

RESTITUTION = 0.85
"""Of a hit that nobody saw."""


def struck(
    places: Array,
    velocities: Array,
    since: Array,
    told: NDArray[np.bool_],
    t: float,
    radius: float,
) -> dict[int, tuple[Array, Array]]:
    """Tell which of n stones have met since they were seen, and where they are expected then.

    Their paths are taken as straight; each stone's first meeting counts, and of the two only
    the push along the line of their centres.

    Parameters
    ----------
    places, velocities : ndarray, shape (n, 2)
        Where each was seen last, m, and how it moved there, m/s.
    since : ndarray, shape (n,)
        When, s.
    told : ndarray of bool, shape (n,)
        Whether its motion is known.
    t : float
        s.
    radius : float
        Of the discs, m.

    Returns
    -------
    dict of int to (place, velocity)
        At time t, by the ranks of the stones.
    """
    speeds = np.hypot(*velocities.T).tolist()
    if not any(speeds):
        return {}
    known, seen = told.tolist(), places.tolist()
    longest = t - min(since.tolist())
    near = [
        (i, j)
        for i, j in combinations(range(len(seen)), 2)
        if (speed := speeds[i] + speeds[j]) > 0
        and known[i]
        and known[j]
        and dist(seen[i], seen[j]) < 2 * radius + speed * longest
    ]
    if not near:
        return {}
    first, second = np.array(near).T
    start = np.maximum(since[first], since[second])
    apart = places[second] + velocities[second] * (start - since[second])[:, None]
    apart = apart - places[first] - velocities[first] * (start - since[first])[:, None]
    closing = velocities[second] - velocities[first]
    # They are two radii apart where |apart + closing s| = 2 R.
    a, b = (closing**2).sum(1), (apart * closing).sum(1)
    c = (apart**2).sum(1) - 4 * radius**2
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    at = start + np.where(a > 0, (-b - root) / np.where(a > 0, a, 1.0), np.inf)
    lasted = np.minimum(since[first], since[second])
    meets = (b < 0) & (b * b > a * c) & (at >= lasted) & (at < t)
    out: dict[int, tuple[Array, Array]] = {}
    for k in np.flatnonzero(meets)[np.argsort(at[meets])].tolist():
        pair = int(first[k]), int(second[k])
        if out.keys() & set(pair):
            continue
        there = [places[i] + velocities[i] * (at[k] - since[i]) for i in pair]
        normal = (there[1] - there[0]) / (2 * radius)
        push = -0.5 * (1 + RESTITUTION) * float(closing[k] @ normal) * normal
        for i, place, change in zip(pair, there, (-push, push), strict=True):
            velocity = velocities[i] + change
            out[i] = place + velocity * (t - at[k]), velocity
    return out
