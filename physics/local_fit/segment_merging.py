"""Merge neighbouring segments of a path that one glide explains.

A stone is slowed the more the slower it is, so that segments of constant acceleration end where
its motion does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.slowing import LEAST, MOST, SHARE, course, power_prior

Floats = NDArray[np.float64]

SPEED_SD, ACCELERATION_SD = 3.0, 0.5
"""Prior of a stretch's velocity (m/s) and acceleration (m/s²) on either axis."""

OUTLIER = 16.0
"""Squared normalised error, two axes, at which a sample costs no more."""

FEWEST = 6
"""Detections from which a stretch tells how it is slowed."""

STEPS = 12
"""Most Gauss-Newton steps of one glide."""


def merge_segments(
    t: Floats, xy: Floats, variance: Floats, starts: Sequence[int], most: float
) -> list[int]:
    """Drop the starts of segments at which a glide goes on.

    Neighbours are merged, the most probable pair first, as long as one glide slowed by a power of
    its speed makes their detections more probable than two do.

    Parameters
    ----------
    t, xy, variance : (n,), (n, 2), (n,) arrays
        Times, places and their variances on either axis.
    starts : sequence of int
        The samples at which all stretches but the first begin.
    most : float
        What a further stretch costs, in units of −2 log likelihood.
    """
    edges = [0, *starts, len(t)]

    def cost(first: int, end: int) -> float:
        return glide_cost(t[first:end], xy[first:end], variance[first:end])

    costs: list[float] = [cost(*ends) for ends in pairwise(edges)]
    both = [cost(edges[k], edges[k + 2]) for k in range(len(costs) - 1)]
    while both:
        apart = np.add(costs[:-1], costs[1:]) + most
        # What is no glide by itself, or too short to tell, tells nothing of its neighbours.
        gains = np.where(np.isfinite(apart), apart, -np.inf) - both
        k = int(np.argmax(gains))
        if not gains[k] > 0:
            break
        costs[k : k + 2] = [both[k]]
        del edges[k + 1], both[k]
        for i in (k - 1, k):
            if 0 <= i < len(both):
                both[i] = cost(edges[i], edges[i + 2])
    return edges[1:-1]


def glide_cost(t: Floats, xy: Floats, variance: Floats) -> float:
    """Minus twice the log likelihood of a stretch as one glide, but for what all stretches share.

    By Laplace's method; parameters are those of `merge_segments`.
    """
    if len(t) < FEWEST:
        return np.inf
    tau = t - t[0]
    c = np.polyfit(tau, xy, 2)[::-1]
    usual = float(SHARE.value or 0.0), float(SHARE.stderr or 0.0)
    power, power_sd = power_prior(float(np.hypot(*c[1])), *usual)
    theta = np.array([*c[:, 0], *c[:, 1], power]) * [1, 1, 2, 1, 1, 2, 1]
    mean = np.append(np.zeros(6), power)
    known = np.array([0.0, SPEED_SD, ACCELERATION_SD, 0.0, SPEED_SD, ACCELERATION_SD, power_sd])
    known[known > 0] **= -2.0
    least, normal = np.inf, np.eye(7)
    for _ in range(STEPS):
        places, slopes = course(theta[:6].reshape(2, 3), tau, float(theta[6]))
        off = xy - places
        distance = np.sum(off**2, axis=1) / variance
        value = float(np.sum(np.minimum(distance, OUTLIER)) + known @ (theta - mean) ** 2)
        if value > least - 0.01:
            break
        least = value
        if 2 * np.sum(distance < OUTLIER) < len(t):
            return np.inf
        weights = np.where(distance < OUTLIER, 1 / variance, 0.0)[:, None, None] * slopes
        normal = np.einsum("nai,naj->ij", weights, slopes) + np.diag(known)
        right = np.einsum("nai,na->i", weights, off) - known * (theta - mean)
        theta = theta + np.linalg.lstsq(normal, right, rcond=None)[0]
        theta[6] = np.clip(theta[6], LEAST, MOST)
    volume = np.linalg.slogdet(normal)[1] - np.sum(np.log(known[known > 0]))
    return float(least + volume + 2 * np.log(variance[0]))
