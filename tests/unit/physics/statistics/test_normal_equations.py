from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from curlshot.physics.statistics.normal_equations import (
    bounded,
    eliminated,
    inverse,
    inverse_of_blocks,
)


def test_unknowns_that_are_eliminated_are_as_if_they_had_been_solved_for() -> None:
    rng = np.random.default_rng(1)
    rows, seen = rng.normal(size=(30, 8)), rng.normal(size=30)
    variance = np.array([0.3, 2.0, 0.0])
    normal, right = rows.T @ rows, rows.T @ seen
    small, value, further = eliminated(normal, right, variance)
    # The same with what is known as three more detections, the third as good as exact.
    full = normal + np.diag([*np.zeros(5), 1 / 0.3, 1 / 2.0, 1e14])
    truth = np.linalg.solve(full, right)
    found = np.linalg.solve(small, value)
    assert found == pytest.approx(truth[:5], abs=1e-9)
    assert further @ np.append(-found, 1.0) == pytest.approx(truth[5:], abs=1e-9)
    assert np.linalg.inv(small) == pytest.approx(np.linalg.inv(full)[:5, :5], abs=1e-9)


def test_rows_of_very_different_size_are_inverted() -> None:
    rng = np.random.default_rng(2)
    rows = rng.normal(size=(20, 4))
    size = np.array([1e-6, 1.0, 1e5, 1e9])
    scaled = (rows * size).T @ (rows * size)
    product = inverse(scaled) * size[:, None] * size @ (rows.T @ rows)
    assert product == pytest.approx(np.eye(4), abs=1e-8)


def test_blocks_are_inverted_one_by_one() -> None:
    rng = np.random.default_rng(3)
    normal = np.zeros((5, 5))
    blocks = [np.array([0, 3]), np.array([1, 2, 4])]
    for block in blocks:
        rows = rng.normal(size=(9, len(block)))
        normal[np.ix_(block, block)] = rows.T @ rows
    assert inverse_of_blocks(normal, blocks) == pytest.approx(np.linalg.inv(normal), abs=1e-10)


def test_a_step_that_a_bound_cuts_off_is_the_best_that_is_left() -> None:
    rng = np.random.default_rng(4)
    rows = rng.normal(size=(30, 4)) + rng.normal(size=(30, 1))  # alike, so that they go together
    seen = rows @ [1.0, -2.0, 3.0, 0.5] + rng.normal(size=30)
    low, high = np.full(4, -np.inf), np.array([0.4, np.inf, np.inf, np.inf])
    step = bounded(rows.T @ rows, rows.T @ seen, low, high)
    assert step[0] == 0.4
    assert step == pytest.approx(lsq_linear(rows, seen, (low, high)).x, abs=1e-6)
    # Merely cut off, it would be a worse one.
    full = bounded(rows.T @ rows, rows.T @ seen, low, -low)
    assert full == pytest.approx(np.linalg.lstsq(rows, seen, rcond=None)[0])
    assert np.abs(np.minimum(full, high) - step).max() > 0.05
