from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.physics.filter.reference_filter import filtered
from curlshot.physics.filter.stretch import (
    ANYWHERE_SD,
    GATE,
    PATIENCE,
    Model,
    Stretch,
    drift,
    steps,
)

N = 9


def stretch(rng: np.random.Generator) -> Stretch:
    """Along x with gaps, at uneven times, its errors partly lasting."""
    t = np.cumsum(rng.uniform(0.02, 0.1, N))
    z = np.column_stack([1.5 * t, 0.0 * t, 0.6 * t]) + rng.normal(0, 0.003, (N, 3))
    z[4] = np.nan
    still = np.zeros(N, bool)
    speed = np.tile([1.5, 0.0], (N, 1))
    return Stretch(
        t, z, np.full((N, 3), 0.003), np.full((N, 3), 0.002), np.zeros(N, int), still, still,
        speed, Model(0.1, 0.02),
    )  # fmt: skip


def whole(own: Stretch) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places and rates of x given all detections at once: a Gaussian conditioned on them."""
    along, turning = steps(own)
    known = drift(own, along, turning)
    start, rates = own.start
    slow = own.slow[0, 0]
    mean, cov = np.zeros(3 * N), np.zeros((3 * N, 3 * N))
    mean[0] = start[0]
    cov[:3, :3] = np.diag([ANYWHERE_SD[0] ** 2, rates[0] ** 2, slow**2])
    for k in range(1, N):
        i = k - 1
        move = np.array([[1, along.reach[i], 0], [0, along.keep[i], 0], [0, 0, along.fade[i]]])
        noise = np.array(
            [
                [along.q00[i], along.q01[i], 0],
                [along.q01[i], along.q11[i], 0],
                [0, 0, (1 - along.fade[i] ** 2) * slow**2],
            ]
        )
        before, now = slice(3 * i, 3 * k), slice(3 * k, 3 * k + 3)
        mean[now] = move @ mean[before]
        cov[now, : 3 * k] = move @ cov[before, : 3 * k]
        cov[: 3 * k, now] = cov[now, : 3 * k].T
        cov[now, now] = move @ cov[before, before] @ move.T + noise
    seen = np.flatnonzero(np.isfinite(own.z[:, 0]))
    shown = np.zeros((len(seen), 3 * N))
    shown[np.arange(len(seen)), 3 * seen] = shown[np.arange(len(seen)), 3 * seen + 2] = 1.0
    total = shown @ cov @ shown.T + np.diag(own.sd[seen, 0] ** 2)
    gain = np.linalg.solve(total, shown @ cov).T
    mean = mean + gain @ ((own.z[:, 0] - known[:, 0])[seen] - shown @ mean)
    spread = np.sqrt(np.diag(cov - gain @ shown @ cov))
    return mean.reshape(N, 3)[:, :2] + known[:, [0, 2]], spread.reshape(N, 3)[:, :2]


@pytest.mark.parametrize("seed", range(3))
def test_smoothing_conditions_on_all_detections(seed: int) -> None:
    own = stretch(np.random.default_rng(seed))
    mean, spread, seen = filtered(own)
    its_mean, its_spread = whole(own)
    np.testing.assert_allclose(mean[:, [0, 2]], its_mean, atol=1e-6)
    np.testing.assert_allclose(spread[:, [0, 2]], its_spread, rtol=1e-3)
    assert seen.tolist() == [1, 1, 1, 1, 0, 1, 1, 1, 1]


def test_an_outlier_is_refused_unless_it_comes_again_and_again() -> None:
    own = stretch(np.random.default_rng(4))
    far = 10 * np.sqrt(GATE) * 0.01
    own.z[5, 0] += far
    assert filtered(own)[2].tolist() == [1, 1, 1, 1, 0, 0, 1, 1, 1]
    own.z[6:, 0] += far
    assert filtered(own)[2][5 : 6 + PATIENCE].tolist() == [0] * PATIENCE + [1]
