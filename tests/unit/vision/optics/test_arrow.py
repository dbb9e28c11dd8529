from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.optics.arrow import Arrow


@pytest.fixture(params=[(5, 9), (3, 0)])
def case(request: pytest.FixtureRequest) -> tuple[Arrow, np.ndarray]:
    """An arrow, and the same as one matrix."""
    first, last = request.param
    rng = np.random.default_rng(0)
    factor = rng.normal(size=(first, first + 4))
    border = rng.normal(size=(first, last))
    diagonal = rng.uniform(1, 100, last)
    dense = factor @ factor.T + border / diagonal @ border.T
    arrow = Arrow(dense, border, diagonal)
    return arrow, np.block([[dense, border], [border.T, np.diag(diagonal)]])


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_solves_as_the_whole_matrix_does(case: tuple[Arrow, np.ndarray], damping: float) -> None:
    arrow, whole = case
    right = np.random.default_rng(1).normal(size=len(whole))
    damped = whole + damping * np.diag(whole.diagonal())
    np.testing.assert_allclose(arrow.solve(right, damping), np.linalg.solve(damped, right))


def test_inverse_is_that_of_the_whole_matrix(case: tuple[Arrow, np.ndarray]) -> None:
    arrow, whole = case
    np.testing.assert_allclose(arrow.inverse() @ whole, np.eye(len(whole)), atol=1e-9)


def test_variances_are_the_last_of_the_inverse(case: tuple[Arrow, np.ndarray]) -> None:
    arrow, whole = case
    last = np.linalg.inv(whole).diagonal()[len(arrow.dense) :]
    np.testing.assert_allclose(arrow.last_variances(), last, rtol=1e-9)
