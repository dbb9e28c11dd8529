"""Half turns that no stone makes: a handle looks nearly the same half a turn on."""

from __future__ import annotations

import numpy as np

from vision.spin.align import Array

FASTEST = 6.0
"""How much faster than before and after, rad/s, no stone turns from one picture to the next: stones
turn at 1 to 3, and hits change that by 3 or so."""

BESIDE, FEWEST = 0.4, 3
"""Time before and after over which spins are told, s, and pictures that tell one."""

LONGEST = 8.0
"""Times as long as spins were watched for, across which they tell how far a stone turned: three
pictures either side whose angles are known to 0.05 rad tell it to 0.4."""


def unfolded(times: Array, angles: Array) -> Array:
    """Take out half turns by which angles change faster than stones turn.

    A handle that was hidden, or hardly seen, may be found again the wrong way round. Where spins
    are told before and after, well enough for the time between, stones turn by what lies between
    the two. Else angles are left as they are after a time in which a stone may have turned so far.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    angles : ndarray, shape (n,)
        rad; NaN where they are not told.

    Returns
    -------
    ndarray, shape (n,)
        rad; the first that is told stays.
    """
    told = np.flatnonzero(np.isfinite(angles))
    t, out = times[told], angles[told]
    far = (np.abs(np.diff(out)) > np.pi / 2) | (np.diff(t) > np.pi / 2 / FASTEST)
    for k in np.flatnonzero(far) + 1:
        wait = t[k] - t[k - 1]
        before = (t < t[k]) & (t >= t[k - 1] - BESIDE)
        after = (t >= t[k]) & (t <= t[k] + BESIDE)
        sides = [side for side in (before, after) if side.sum() >= FEWEST]
        spins = [np.polyfit(t[side], out[side], 1)[0] for side in sides]
        off = out[k] - out[k - 1] - wait * (np.mean(spins) if spins else 0.0)
        halves = np.round(off / np.pi)
        most = FASTEST * wait
        if len(spins) == 2 and wait <= LONGEST * min(np.ptp(t[side]) for side in sides):
            most = min(most, 0.5 * wait * abs(spins[1] - spins[0]) + np.pi / 2)
        if abs(off) > most and abs(off - np.pi * halves) < np.pi / 4:
            out[k:] -= np.pi * halves
    unfolded_angles = angles.copy()
    unfolded_angles[told] = out
    return unfolded_angles
