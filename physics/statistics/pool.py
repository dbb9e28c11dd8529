"""One value from many shots: what a season says of e and μ.

Shots differ by more than their stated errors: stones, ice and speed are not the same. So the
value of a shot is a draw from a normal distribution about the season's mean, with a scatter that
is itself unknown, and is measured with its own error (random-effects meta-analysis; DerSimonian
and Laird 1986). With few shots the scatter is poorly known, and a plug-in estimate of it gives
errors that are too small; here the mean is averaged over all scatters by their posterior, with a
half-normal prior (Röver 2020, Bayesian random-effects meta-analysis).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESTITUTION_SCATTER = 0.05
"""Scale of the prior of the scatter of e: published values lie within some 0.1 of each other."""

FRICTION_SCATTER = 0.0025
"""Scale of the prior of the scatter of μ: ice of a hall from 0.006 to 0.016."""

_GRID = 400
_REACH = 4.0


@dataclass(frozen=True)
class Pooled:
    """The mean of many shots.

    Attributes
    ----------
    value, stderr : float or None
        Mean over shots like these, and its standard error; None without any shot.
    scatter, stderr_scatter : float or None
        Standard deviation from shot to shot, beyond the errors of measurement; None for fewer
        than two shots.
    shots : int
        How many values there were.
    """

    value: float | None
    stderr: float | None
    scatter: float | None
    stderr_scatter: float | None
    shots: int


def pool(values: Sequence[float], stderrs: Sequence[float], prior_scatter: float) -> Pooled:
    """Estimate the mean of many shots and their scatter.

    Parameters
    ----------
    values, stderrs : sequence of float, length n
        One per shot; standard errors above zero.
    prior_scatter : float
        Scale of the half-normal prior of the scatter, in the unit of the values; that of the
        values themselves where they lie wider.

    Returns
    -------
    Pooled

    Raises
    ------
    ValueError
        Where the lengths differ, a number is not finite, or an error is not above zero.
    """
    y, s = np.asarray(values, float), np.asarray(stderrs, float)
    if y.shape != s.shape or y.ndim != 1 or not (np.isfinite(y).all() and np.isfinite(s).all()):
        raise ValueError("values and standard errors must be finite and equally many")
    if np.any(s <= 0) or not prior_scatter > 0:
        raise ValueError("standard errors and the scale of the prior must be above zero")
    if not len(y):
        return Pooled(None, None, None, None, 0)
    # Shots that differ by far more than the prior thought of are not to be argued away.
    scale = max(prior_scatter, float(np.std(y, ddof=1))) if len(y) > 1 else prior_scatter
    # The integrand is smooth in the scatter, and none of it lies beyond a few prior scales.
    tau = (np.arange(_GRID) + 0.5) * (_REACH * scale / _GRID)
    variance = s**2 + tau[:, None] ** 2
    weight = 1 / variance
    total = weight.sum(1)
    mean = (weight * y).sum(1) / total
    misfit = (weight * (y - mean[:, None]) ** 2).sum(1)
    log = -0.5 * (np.log(variance).sum(1) + np.log(total) + misfit + (tau / scale) ** 2)
    share = np.exp(log - log.max())
    share /= share.sum()
    value = float(share @ mean)
    stderr = float(np.sqrt(share @ (1 / total + (mean - value) ** 2)))
    if len(y) < 2:
        return Pooled(value, stderr, None, None, 1)
    scatter = float(share @ tau)
    return Pooled(value, stderr, scatter, float(np.sqrt(share @ (tau - scatter) ** 2)), len(y))
