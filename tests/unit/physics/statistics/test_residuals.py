from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.statistics.residuals import (
    HUBER,
    _products,
    autocorrelation_factor,
    huber_weights,
    inflation,
)


def test_alike_errors_are_told_from_white_ones() -> None:
    rng = np.random.default_rng(64)
    white = [(rng.normal(size=(60, 2)), 3) for _ in range(12)]
    assert autocorrelation_factor(white) < 1.4
    keep = 0.8
    alike = []
    for _ in range(12):
        r = rng.normal(size=(60, 2))
        for k in range(1, 60):
            r[k] = keep * r[k - 1] + np.sqrt(1 - keep**2) * r[k]
        alike.append((r - r.mean(axis=0), 1))
    assert autocorrelation_factor(alike) == pytest.approx((1 + keep) / (1 - keep), rel=0.4)
    assert autocorrelation_factor([]) == 1.0
    assert autocorrelation_factor([(np.zeros((20, 2)), 1)]) == 1.0


def test_products_of_neighbours_are_summed_run_by_run() -> None:
    rng = np.random.default_rng(66)
    runs = [rng.normal(size=shape) for shape in ((61, 2), (8, 2), (40, 3))]
    due = [[np.sum(run[lag:] * run[:-lag]) for lag in range(1, 12)] for run in runs]
    np.testing.assert_allclose(_products(runs, 11), due, atol=1e-9)


def test_a_detection_far_off_weighs_less_whatever_the_axes() -> None:
    weights = huber_weights(np.array([[0.0, 0.0], [2.9, 0.0], [-3.6, 4.8]]))
    assert weights[:, 0] == pytest.approx([1.0, 1.0, HUBER / 6])


def test_variances_grow_by_what_residuals_are_larger_but_never_shrink() -> None:
    rng = np.random.default_rng(65)
    white = rng.normal(size=(400, 2))
    for size, factor in ((1.3, 1.69), (0.5, 1.0)):
        # The farthest of the larger ones are weighted down.
        assert inflation([(size * white, 3)], 800 - 6) == pytest.approx(factor, rel=0.15)
    assert inflation([(white, 3)], 0.5) == 1.0
