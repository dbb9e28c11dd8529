"""Hits just before the end, of which too few pictures are left to tell them.

A stone that is hit between the last two pictures is seen aside once: that may be an outlier too, so
it is said to lie where it lay, and the other one to go on. Where both come to touch on their ways
the errors of what is said of these pictures hold what a hit would have changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import erf, sqrt
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from curlshot.data.tracks import Columns
from curlshot.physics.filter.stretch import JUMP_SD
from curlshot.physics.local_fit.hit_detection import HitCandidate

Floats = NDArray[np.float64]

LAST = 2
"""Pictures after a hit, by less of which it may not be told."""

CHANGE = 1.84
"""By what share of the closing speed a hit changes that at which two stones part: 1 + e, with
e = 0.84. Each has as much of it as the other one's mass has of both."""


def widen_last(
    tracks: Mapping[str, Columns],
    hits: Sequence[HitCandidate],
    radius: float,
    masses: Mapping[str, float] | None = None,
    duplicates: Mapping[str, int] = MappingProxyType({}),
) -> None:
    """Widen the errors in the last pictures of stones that may have hit each other in them.

    With the probability p that a row comes after the hit, p times the square of what it would
    change there is added to the variances.

    Parameters
    ----------
    tracks : mapping of str to Columns
        Stone to its rows (`curlshot.data.tracks.TRACK_COLUMNS`); standard deviations are changed.
    hits : sequence of HitCandidate
        Those that are told.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; 1 where absent.
    duplicates : mapping of str to int
        How many of its last rows are of frames that repeat the last in which it was seen.
    """
    masses = masses or {}
    for first, second in combinations(tracks, 2):
        pair = tracks[first], tracks[second]
        last = LAST + duplicates.get(first, 0)
        if min(len(rows["t"]) for rows in pair) <= last or pair[0]["t"][-1] != pair[1]["t"][-1]:
            continue
        t = pair[0]["t"][-1 - last :]
        if not any(hit.t > t[0] and {*hit.stones} & {first, second} for hit in hits):
            _widen(pair, t, radius, (masses.get(first, 1.0), masses.get(second, 1.0)))


def _widen(
    pair: tuple[Columns, Columns], t: Floats, radius: float, mass: tuple[float, float]
) -> None:
    """Widen the errors of two stones at the last times t, s: from the first of them they go on."""
    last = len(t) - 1
    state, sd = (
        [np.array([rows[name][-1 - last] for name in names]) for rows in pair]
        for names in (("x", "y", "vx", "vy"), ("sd_x", "sd_y"))
    )
    apart, drift = np.split(state[1] - state[0], 2)
    towards, speed = -float(apart @ drift), float(np.hypot(*drift))
    left = towards**2 - speed**2 * (float(apart @ apart) - 4 * radius**2)
    if not towards > 0 or not left > 0:
        return  # they part, or pass each other, or one was seen once alone
    wait = (towards - sqrt(left)) / speed**2
    normal = (apart + wait * drift) / (2 * radius)
    closing = -float(drift @ normal)
    sd_wait = float(np.hypot(*(np.hypot(*sd) * normal))) / closing
    changes = [CHANGE * closing * other / sum(mass) for other in mass[::-1]]
    for k in range(1, last + 1):
        since = float(t[k] - t[0]) - wait
        after = sqrt(0.5 + 0.5 * erf(since / (sqrt(2) * sd_wait)))
        for rows, most in zip(pair, changes, strict=True):
            at = k - last - 1
            for axis, change in zip("xy", (after * most * np.abs(normal)).tolist(), strict=True):
                way = change * max(since, sd_wait)
                rows[f"sd_{axis}"][at] = np.hypot(rows[f"sd_{axis}"][at], way)
                rows[f"sd_v{axis}"][at] = np.hypot(rows[f"sd_v{axis}"][at], change)
            spin = JUMP_SD[1] * after * most
            rows["sd_omega"][at] = np.hypot(rows["sd_omega"][at], spin)
