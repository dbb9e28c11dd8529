"""The filter of `curlshot.physics.kalman` in matrices, by filterpy, to which `rate_filter` is held.

Slower by far, and nothing but the textbook's equations. Whoever wants to couple the pairs
(curl, say) begins here: ``smooth(…, run=reference_filter.filtered)``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import (
    ANYWHERE_SD,
    Gate,
    Smoothed,
    Steps,
    Stretch,
    drift,
    steps,
)

Floats = NDArray[np.float64]

PAIRS = ((0, 2, 6), (1, 3, 7), (4, 5, 8))
"""Ranks of place, rate and lasting error in the state x, y, vx, vy, θ, ω, and the errors."""


def filtered(stretch: Stretch) -> Smoothed:
    """Filter and smooth one stretch between two hits: as `physics.filter.rate_filter.filtered`."""
    from filterpy.kalman import KalmanFilter

    n = len(stretch.t)
    along, turning = steps(stretch)
    slow = np.maximum(stretch.slow, 1e-9)  # its covariances are inverted
    moves, noises = _matrices((along, along, turning), slow)
    known = drift(stretch, along, turning)
    values = stretch.z - known[:, [0, 1, 4]]
    places, rates = stretch.start
    filter_ = KalmanFilter(dim_x=9, dim_z=3)
    filter_.x, filter_.P = np.zeros(9), np.zeros((9, 9))
    anywhere = (ANYWHERE_SD[0], ANYWHERE_SD[0], ANYWHERE_SD[1])
    for (place, rate, _), start, sd, rate_sd in zip(PAIRS, places, anywhere, rates, strict=True):
        filter_.x[place] = start
        filter_.P[place, place], filter_.P[rate, rate] = sd**2, rate_sd**2
    filter_.P[range(6, 9), range(6, 9)] = slow[0] ** 2
    rows = np.eye(9)[[0, 1, 4]] + np.eye(9)[6:]
    means, covs = np.empty((n, 9)), np.empty((n, 9, 9))
    seen = np.zeros(n, dtype=int)
    of_places, of_angles = Gate(), Gate()
    for k in range(n):
        if k:
            filter_.predict(F=moves[k], Q=noises[k])
        if np.isfinite(values[k, 0]):
            seen[k] = _update(filter_, rows[:2], values[k, :2], stretch.sd[k, :2], of_places)
        if np.isfinite(values[k, 2]):
            _update(filter_, rows[2:], values[k, 2:], stretch.sd[k, 2:], of_angles)
        means[k], covs[k] = filter_.x, filter_.P
    # The method reads Fs[k + 1] on the way from k + 1 to k, as uneven steps need.
    mean, cov, _, _ = filter_.rts_smoother(means, covs, list(moves), list(noises))
    spread = np.sqrt(np.maximum(np.diagonal(cov, axis1=1, axis2=2), 0.0))
    mean, spread = mean[:, :6] + known, spread[:, :6]
    mean[stretch.rest, 2:4], mean[stretch.idle, 5] = 0.0, 0.0
    return mean, spread, seen


def _update(filter_: Any, rows: Floats, value: Floats, sd: Floats, gate: Gate) -> bool:
    """Use a detection that passes the gate."""
    error = value - rows @ filter_.x
    spread = rows @ filter_.P @ rows.T + np.diag(sd**2)
    passes = gate.passes(float(error @ np.linalg.solve(spread, error)))
    if passes:
        filter_.update(value, R=np.diag(sd**2), H=rows)
    return passes


def _matrices(pairs: tuple[Steps, Steps, Steps], slow: Floats) -> tuple[Floats, Floats]:
    """Transition and noise of each step, shape (n, 9, 9); the first leads nowhere."""
    count = len(pairs[0].reach)
    moves, noises = np.zeros((count + 1, 9, 9)), np.zeros((count + 1, 9, 9))
    moves[0] = np.eye(9)
    for (place, rate, lasting), way in zip(PAIRS, pairs, strict=True):
        moves[1:, place, place], moves[1:, place, rate] = 1.0, way.reach
        moves[1:, rate, rate], moves[1:, lasting, lasting] = way.keep, way.fade
        noises[1:, place, place], noises[1:, rate, rate] = way.q00, way.q11
        noises[1:, lasting, lasting] = (1 - way.fade**2) * slow[1:, lasting - 6] ** 2
        noises[1:, place, rate] = noises[1:, rate, place] = way.q01
    return moves, noises
