"""Where a spin ends at once as its stone comes to rest.

A stone that comes to rest is held by the ice, and so is its spin: it ends within a frame, or the
stone goes on turning on the spot for a while. A filter to which a spin is something smooth
rounds the end off, and is wrong on either side of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

UNSURE = 0.2
"""How well the time at which a stone comes to rest is known, s: in its last 0.2 s it goes 2 mm."""

NEAR = 0.6
"""How far from there angles have a say, s."""

FEWEST = 5
"""Angles about the end below which nothing is told of it."""

BETTER = 0.55
"""How much less must be left, as a share, of a spin that ends at once than of one that changes
steadily: of 64 clips whose truth is known 12 of 13 spins that ended so left 0.5 at most, as a rule
0.2, and of one the rest was found too early to tell; of the others one left 0.4, the next 0.6."""


SHARPEST = 1e-4
"""Smallest standard deviation of an angle that counts, rad: a table without noise states none."""


def spin_ends(t: Floats, theta: Floats, sd: Floats, rest: Bools) -> Bools:
    """Tell in which steps between the times a spin ends at once.

    Parameters
    ----------
    t : (n,) array
        s, increasing.
    theta, sd : (n,) array
        Angles and their standard deviations, rad; NaN where not seen.
    rest : (n,) array of bool
        Whether the stone rests.

    Returns
    -------
    (n - 1,) array of bool
    """
    ends = np.zeros(len(t) - 1, dtype=bool)
    for row in np.flatnonzero(rest[1:] & ~rest[:-1]) + 1:
        away = np.abs(t - t[row])
        near = np.flatnonzero((away <= NEAR) & np.isfinite(theta))
        if len(near) < FEWEST:
            continue
        tau, angle, weight = t[near] - t[row], theta[near], 1 / np.maximum(sd[near], SHARPEST)
        most, best = BETTER * _left(tau, angle, weight, tau**2), -1
        for step in np.flatnonzero(away[1:] <= UNSURE):
            past = np.minimum(tau - (0.5 * (t[step] + t[step + 1]) - t[row]), 0.0)
            left = _left(past, angle, weight) if (past < 0).sum() > 1 else np.inf
            if left < most - 1:  # by more than one error: exact angles leave rounding errors
                most, best = left, int(step)
        if best >= 0:
            ends[best] = True
    return ends


def _left(tau: Floats, angle: Floats, weight: Floats, *more: Floats) -> float:
    """Weighted sum of squares that a line in `tau`, and what else is given, leaves of angles."""
    basis = np.stack([np.ones_like(tau), tau, *more], axis=1) * weight[:, None]
    values = angle * weight
    rest = values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]
    return float(rest @ rest)
