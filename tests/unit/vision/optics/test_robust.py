from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.optics.robust import inverse, loss, regress, spread


def test_the_loss_is_square_near_and_flat_far() -> None:
    r = np.array([0.0, 0.01, 1.0, 100.0])
    found = loss(r, 3.0)
    np.testing.assert_allclose(found[:2], r[:2] ** 2 / 2, rtol=1e-4)
    assert found[2] < 0.5
    # Its slope r / (1 + (r / 3)²) falls off as 9 / r.
    slope = (loss(r + 1e-4, 3.0) - loss(r - 1e-4, 3.0)) / 2e-4
    np.testing.assert_allclose(slope, r / (1 + (r / 3) ** 2), rtol=1e-4, atol=1e-9)


def test_what_is_out_of_reach_does_not_spread() -> None:
    rms, good = spread(np.array([1.0, -1.0, 50.0]), np.array([0.3, 0.4, 1.0]), 3.0)
    assert good.tolist() == [True, True, False]
    assert rms == pytest.approx(np.sqrt((0.3**2 + 0.4**2) / 2))
    assert np.isnan(spread(np.array([9.0]), np.ones(1), 3.0)[0])


def test_inverse() -> None:
    matrix = np.array([[4.0, 1.0], [1.0, 3.0]])
    np.testing.assert_allclose(inverse(matrix) @ matrix, np.eye(2), atol=1e-12)


def test_a_line_is_fitted_beside_outliers() -> None:
    x = np.linspace(-1, 1, 60)
    value = 2.0 + 3.0 * x + 0.01 * np.random.default_rng(1).normal(size=60)
    value[::10] += 5.0
    known = np.stack([np.ones(60), x], axis=1)
    found, cov, scatter = regress(known, value, width=3.0, least=1e-3, rounds=6)
    assert found == pytest.approx([2.0, 3.0], abs=0.01)
    assert scatter == pytest.approx(0.011, rel=0.4)
    assert np.diag(cov) == pytest.approx([1 / 54, 3 / 54], rel=0.3)
