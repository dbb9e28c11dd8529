"""The filter of `physics.kalman` in matrices, by filterpy: what `physics.rate_filter` is held to.

Slower by far, and nothing but the textbook's equations. Whoever wants to couple the pairs
(curl, say) begins here: ``smooth(…, run=reference_filter.filtered)``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from physics.stretch import ANYWHERE_SD, GATE, PATIENCE, Estimates, Steps, Stretch, drift, steps

Floats = NDArray[np.float64]

PAIRS = ((0, 2), (1, 3), (4, 5))
"""Ranks of place and rate in the state x, y, vx, vy, θ, ω."""


def filtered(stretch: Stretch) -> Estimates:
    """Filter and smooth one stretch between two hits: as `physics.rate_filter.filtered`."""
    from filterpy.kalman import KalmanFilter

    n = len(stretch.t)
    along, turning = steps(stretch)
    moves, noises = _matrices((along, along, turning))
    known = drift(stretch, along)
    values = stretch.z - known[:, [0, 1, 4]]
    places, rates = stretch.start
    filter_ = KalmanFilter(dim_x=6, dim_z=3)
    filter_.x, filter_.P = np.zeros(6), np.zeros((6, 6))
    anywhere = (ANYWHERE_SD[0], ANYWHERE_SD[0], ANYWHERE_SD[1])
    for (place, rate), start, sd, rate_sd in zip(PAIRS, places, anywhere, rates, strict=True):
        filter_.x[place] = start
        filter_.P[place, place], filter_.P[rate, rate] = sd**2, rate_sd**2
    rows = np.eye(6)[[0, 1, 4]]
    means, covs = np.empty((n, 6)), np.empty((n, 6, 6))
    seen = np.zeros(n, dtype=int)
    refused = wrong = 0
    for k in range(n):
        if k:
            filter_.predict(F=moves[k], Q=noises[k])
        if np.isfinite(values[k, 0]):
            if _near(filter_, rows[:2], values[k, :2], stretch.sd[k, :2]) or refused >= PATIENCE:
                seen[k], refused = 1, 0
                filter_.update(values[k, :2], R=np.diag(stretch.sd[k, :2] ** 2), H=rows[:2])
            else:
                refused += 1
        if np.isfinite(values[k, 2]):
            if _near(filter_, rows[2:], values[k, 2:], stretch.sd[k, 2:]) or wrong >= PATIENCE:
                wrong = 0
                filter_.update(values[k, 2:], R=np.diag(stretch.sd[k, 2:] ** 2), H=rows[2:])
            else:
                wrong += 1
        means[k], covs[k] = filter_.x, filter_.P
    # The method reads Fs[k + 1] on the way from k + 1 to k, as uneven steps need.
    mean, cov, _, _ = filter_.rts_smoother(means, covs, list(moves), list(noises))
    spread = np.sqrt(np.maximum(np.diagonal(cov, axis1=1, axis2=2), 0.0))
    mean = mean + known
    mean[stretch.rest, 2:4], mean[stretch.idle, 5] = 0.0, 0.0
    return mean, spread, seen


def _near(filter_: Any, rows: Floats, value: Floats, sd: Floats) -> bool:
    """Whether the squared normalised innovation of a sighting lies within the gate."""
    error = value - rows @ filter_.x
    spread = rows @ filter_.P @ rows.T + np.diag(sd**2)
    return float(error @ np.linalg.solve(spread, error)) < GATE


def _matrices(pairs: tuple[Steps, Steps, Steps]) -> tuple[Floats, Floats]:
    """Transition and noise of each step, shape (n, 6, 6); the first leads nowhere."""
    count = len(pairs[0].reach)
    moves, noises = np.zeros((count + 1, 6, 6)), np.zeros((count + 1, 6, 6))
    moves[0] = np.eye(6)
    for (place, rate), way in zip(PAIRS, pairs, strict=True):
        moves[1:, place, place], moves[1:, place, rate] = 1.0, way.reach
        moves[1:, rate, rate] = way.keep
        noises[1:, place, place], noises[1:, rate, rate] = way.q00, way.q11
        noises[1:, place, rate] = noises[1:, rate, place] = way.q01
    return moves, noises
