"""The mean of values that differ by more than their errors."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from curlshot.data.estimates import Estimate

Floats = NDArray[np.float64]

HALVINGS = 60
"""Of the interval in which the spread is sought: to the last digit."""


@dataclass(frozen=True)
class RandomEffects:
    """Mean of values each of which differs from it by itself, beyond its error.

    Attributes
    ----------
    mean : Estimate
        With the standard error that the spread and the errors give it.
    spread : float
        Standard deviation of the values beyond their errors; 0 where chance explains it.
    excess : float
        By how many of its standard deviations the misfit of one value for all is too large.
    """

    mean: Estimate = field(default_factory=Estimate)
    spread: float = 0.0
    excess: float = 0.0


def random_effects(values: Floats, cov: Floats) -> RandomEffects:
    """Estimate the mean of values that differ, and how much they do.

    The spread is that with which the values scatter about their mean as they should (Paule and
    Mandel, 1982, J. Res. Natl. Bur. Stand. 87, 377). A few sharp values that happen to agree
    do not hide how far all others lie from them.

    Parameters
    ----------
    values : (n,) array
    cov : (n, n) array
        Covariance of their errors.
    """
    free = len(values) - 1
    if free < 0:
        return RandomEffects()
    mean, stderr, misfit = weighted_mean(values, cov, 0.0)
    if not free:
        return RandomEffects(Estimate(mean, stderr))
    excess = (misfit - free) / float(np.sqrt(2 * free))
    if excess <= 1:  # two or three values show some spread by chance alone
        return RandomEffects(Estimate(mean, stderr), 0.0, excess)
    low, high = 0.0, float(np.ptp(values)) ** 2 * (free + 1)
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if weighted_mean(values, cov, middle)[2] > free:
            low = middle
        else:
            high = middle
    mean, stderr, _ = weighted_mean(values, cov, high)
    return RandomEffects(Estimate(mean, stderr), float(np.sqrt(high)), excess)


def weighted_mean(values: Floats, cov: Floats, spread: float) -> tuple[float, float, float]:
    """Weighted mean with a variance between the values, its error, and the misfit."""
    inverse = np.linalg.inv(cov + spread * np.eye(len(values)))
    weights = inverse.sum(axis=1)
    mean = float(weights @ values / weights.sum())
    off = values - mean
    return mean, float(weights.sum() ** -0.5), float(off @ inverse @ off)
