"""What the robust fits of cameras share: the Cauchy loss, what lies within reach, inverses."""

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
