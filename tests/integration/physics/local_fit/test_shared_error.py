"""Straight paths on a map that is wrong by a field: what the fit's unknowns owe to it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.physics.local_fit.shared_error import _shown, shared_error
from curlshot.physics.local_fit.traces import CORRELATION_LENGTH, Trace

Floats = NDArray[np.float64]
COUNT, SIZE, SD = 150, 2e-3, 4e-4
T = np.linspace(0, 3, COUNT)
BASIS = np.stack([np.ones(COUNT), T, T**2], axis=1)


def fitted(
    field: float, stated: float, rng: np.random.Generator, t: Floats = T
) -> tuple[Floats, Floats]:
    """Errors of the six unknowns of a parabola in time, and the variances that are stated."""
    path = np.stack([0.2 * t, 1.6 * t - 0.1 * t**2], axis=1)
    apart = np.sum((path[:, None] - path[None]) ** 2, axis=2)
    root = np.linalg.cholesky(np.exp(-apart / (2 * CORRELATION_LENGTH**2)) + 1e-9 * np.eye(COUNT))
    off = field * root @ rng.normal(size=(COUNT, 2)) + SD * rng.normal(size=(COUNT, 2))
    by_axis = np.zeros((COUNT, 2, 6))
    for axis in range(2):
        basis = np.stack([np.ones(COUNT), t, t**2], axis=1)
        by_axis[:, axis, 3 * axis : 3 * axis + 3] = -basis / SD
    slopes = by_axis.reshape(2 * COUNT, 6)
    cov = np.asarray(np.linalg.inv(slopes.T @ slopes), float)
    found = -cov @ slopes.T @ (off / SD).ravel()
    residuals = (off / SD).ravel() + slopes @ found
    trace = Trace(
        "A", t, path + off, np.full((COUNT, 2), SD), np.full(COUNT, np.nan),
        np.full(COUNT, np.nan), np.full((COUNT, 2), stated), np.zeros((COUNT, 2)),
    )  # fmt: skip
    shared = shared_error({"A": trace}, residuals.reshape(-1, 2), slopes, cov, np.ones(2 * COUNT))
    return found, np.diag(cov + shared)


@pytest.mark.parametrize(("field", "low", "high"), [(SIZE, 0.8, 1.25), (3 * SIZE, 0.6, 1.1)])
def test_a_field_larger_than_stated_shows_in_the_errors(
    field: float, low: float, high: float
) -> None:
    """Stated or three times as large: errors follow what residuals show, by half."""
    rng = np.random.default_rng(0)
    errors, variances = map(
        np.array, zip(*(fitted(field, SIZE, rng) for _ in range(150)), strict=True)
    )
    ratio = np.sqrt(variances.mean(axis=0) / np.mean(errors**2, axis=0))
    assert ratio.min() > low
    assert ratio.max() < high


def test_a_field_smaller_than_stated_does_too() -> None:
    rng = np.random.default_rng(1)
    wide = np.mean([fitted(SIZE, SIZE, rng)[1] for _ in range(40)], axis=0)
    none = np.mean([fitted(0.0, SIZE, rng)[1] for _ in range(40)], axis=0)
    assert np.all(none < 0.75 * wide)
    assert np.all(none > 0.4 * wide)  # what is stated keeps its say


def test_a_path_so_short_that_nothing_of_the_field_is_left_has_the_errors_that_are_stated() -> None:
    """Noise is no sign of a larger field where the fit follows whatever field there is."""
    rng = np.random.default_rng(3)
    each = [fitted(SIZE, SIZE, rng, 0.25 * T) for _ in range(100)]
    errors, variances = map(np.array, zip(*each, strict=True))
    ratio = np.sqrt(variances.mean(axis=0) / np.mean(errors**2, axis=0))
    assert np.all((ratio > 0.8) & (ratio < 1.5))


@pytest.mark.parametrize(
    ("noise", "low", "high"), [(0.0, 3.5, 4.5), (1.0, 2.0, 3.0), (1e6, 0.9, 1.1)]
)
def test_noise_hides_how_large_a_field_is(noise: float, low: float, high: float) -> None:
    """Of a field twice as large as stated, known alone, beside noise of its size, and under it."""
    rng = np.random.default_rng(4)
    left, noises = np.ones((2000, 2)), np.full((2000, 2), noise)
    off = rng.normal(size=left.shape) * np.sqrt(4 * left + noises)
    assert low < _shown(off, left, noises) < high


def test_places_that_share_nothing_add_nothing() -> None:
    _, plain = fitted(0.0, 0.0, np.random.default_rng(2))
    slopes = -BASIS / SD
    assert plain[:3] == pytest.approx(np.diag(np.linalg.inv(slopes.T @ slopes)), rel=1e-9)
