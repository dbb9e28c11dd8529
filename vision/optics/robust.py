"""Robust fits: Cauchy's loss, inliers, and regression by iteratively reweighted least squares."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDTH = 3.0
"""Width of the Cauchy loss, in standard deviations."""


def loss(r: Array, width: float) -> Array:
    """Cauchy loss of each residual in standard deviations."""
    relative = (1 / width) * r
    return 0.5 * width**2 * np.log1p(relative * relative)


def spread(r: Array, sd: Array, width: float) -> tuple[float, NDArray[np.bool_]]:
    """Root mean square of the inlying residuals, px, and which these are."""
    good = np.abs(r) < width
    px = (r * sd)[good]
    return math.sqrt(px @ px / len(px)) if len(px) else math.nan, good


def inverse(matrix: Array) -> Array:
    """Invert a symmetric positive definite matrix."""
    return np.asarray(np.linalg.inv(matrix), np.float64)


def regress(
    known: Array, value: Array, *, width: float, least: float, rounds: int
) -> tuple[Array, Array, float]:
    """Fit values by columns, with Cauchy's loss about as wide as they scatter.

    Parameters
    ----------
    known : ndarray, shape (n, columns)
    value : ndarray, shape (n,)
    width : float
        Width of the loss, in standard deviations.
    least : float
        The least by which values scatter, in their unit.
    rounds : int
        How often they are weighed anew.

    Returns
    -------
    found : ndarray, shape (columns,)
    cov : ndarray, shape (columns, columns)
        Its covariance where values scatter by 1, each on its own.
    scatter : float
        By which they do.
    """
    weight = np.ones(len(value))
    for _ in range(rounds):
        cov = inverse(known.T @ (weight[:, None] * known) + 1e-9 * np.eye(known.shape[1]))
        found = cov @ (known.T @ (weight * value))
        off = value - known @ found
        scatter = 1.5 * float(np.median(np.abs(off))) + least
        weight = 1 / (1 + (off / (width * scatter)) ** 2)
    return found, cov, scatter
