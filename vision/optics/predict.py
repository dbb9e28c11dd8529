"""Prediction of the next views: polynomials through the last ones, of the degree that did best."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_DEGREE = 2
"""Highest degree: the views gather speed evenly."""

CHECKED = 2
"""As many of the last views are used to see which degree would have foretold them best."""

BETTER = 0.5
"""By this share its errors must be less for a higher degree to be chosen: it doubles noise."""

MEMORY = MOST_DEGREE + 1 + CHECKED
"""Number of views of which any more than these say nothing."""

FAR = 4.0
"""Beyond so many times the span of the last views nothing is foretold: the last one stays."""


def predict(times: Sequence[float], vectors: Array, ahead: Sequence[float]) -> Array:
    """Extrapolate vectors.

    Parameters
    ----------
    times : sequence of float
        When they were so, s; in order, forwards or backwards.
    vectors : ndarray, shape (n, m)
        At least one; those before the last `MEMORY` are not used.
    ahead : sequence of float
        When they are asked for, s.

    Returns
    -------
    ndarray, shape (len(ahead), m)
    """
    times, vectors = list(times)[-MEMORY:], vectors[-MEMORY:]
    best, least = 0, np.inf
    for degree in range(min(MOST_DEGREE, len(times) - 1) + 1):
        checked = range(max(len(times) - CHECKED, degree + 1), len(times))
        error = max(
            (
                float(np.abs(_through(times[:k], vectors[:k], times[k], degree) - vectors[k]).max())
                for k in checked
            ),
            default=np.inf,
        )
        if error < BETTER * least or (degree == 1 and not checked):
            best, least = degree, error
    reach = FAR * abs(times[-1] - times[0])
    return np.array(
        [_through(times, vectors, t, best if abs(t - times[-1]) <= reach else 0) for t in ahead]
    )


def _through(times: Sequence[float], vectors: Array, t: float, degree: int) -> Array:
    """Value at `t` of the polynomial through the last of the vectors (Lagrange's form)."""
    last = times[-degree - 1 :]
    weights = []
    for k, at in enumerate(last):
        weight = 1.0
        for i, other in enumerate(last):
            if i != k:
                weight *= (t - other) / (at - other)
        weights.append(weight)
    return np.asarray(weights @ vectors[-degree - 1 :])
