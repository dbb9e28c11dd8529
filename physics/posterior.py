"""A sample of what restitution and frictions may be, given the shot."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import Estimate, Posterior
from curlshot.physics.estimate import LAWS, Estimates

Floats = NDArray[np.float64]

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
"""Quantiles of the summary."""

NO_SAMPLES = "no samples: neither restitution nor friction is identifiable"
"""Warning of a shot of which samples were asked for and there are none."""

BATCHES = 100
"""Batches of draws among which those that can be must be found."""

POSSIBLE = {"restitution": (0.0, 1.5), "friction": (0.0, 1.0), "stone_friction": (0.0, 2.0)}
"""What each may be."""


def sample_posterior(
    estimates: Estimates, count: int, rng: np.random.Generator
) -> pd.DataFrame | None:
    """Draw restitution and frictions from their joint distribution.

    It is taken as normal about the best fit, with all its errors, within what the quantities may
    be: Laplace's approximation. Where the whole shot was not fitted the estimates from beside
    the hits are drawn, one independent of the other.

    Parameters
    ----------
    estimates : Estimates
        Of the shot.
    count : int
        Number of draws; of 0 there is no sample.
    rng : Generator
        Of the random numbers.

    Returns
    -------
    DataFrame or None
        ``sample, restitution, friction, stone_friction``, NaN in a column that the shot does not
        tell; None where it tells none or no draw is asked for.

    Raises
    ------
    InputError
        Where the estimates are so far from what can be that no draw is possible.
    """
    mean, cov = _joint(estimates)
    told = np.isfinite(mean)
    if not told.any() or not count:
        return None
    low, high = np.array([POSSIBLE[name] for name in LAWS]).T[:, told]
    rows = np.empty((0, int(told.sum())))
    for _ in range(BATCHES):
        drawn = rng.multivariate_normal(mean[told], cov[np.ix_(told, told)], count, method="eigh")
        rows = np.concatenate([rows, drawn[((low <= drawn) & (drawn <= high)).all(axis=1)]])
        if len(rows) >= count:
            break
    else:
        raise InputError("posterior: the estimates are impossible; nothing can be drawn")
    table = pd.DataFrame(np.nan, index=range(count), columns=list(LAWS))
    table.loc[:, np.array(LAWS)[told].tolist()] = rows[:count]
    table.insert(0, "sample", np.arange(count))
    return table


def summarise(sample: pd.DataFrame) -> Posterior:
    """Quantiles and correlations of a sample of `sample_posterior`."""
    told = [name for name in LAWS if sample[name].notna().all()]
    values = sample[told].to_numpy(float)
    quantiles = np.quantile(values, QUANTILES, axis=0)
    alike = np.atleast_2d(np.corrcoef(values, rowvar=False))
    return Posterior(
        len(sample),
        {
            name: {f"{q:g}": float(v) for q, v in zip(QUANTILES, quantiles[:, k], strict=True)}
            for k, name in enumerate(told)
        },
        {
            name: {other: float(alike[k, j]) for j, other in enumerate(told)}
            for k, name in enumerate(told)
        },
    )


def _joint(estimates: Estimates) -> tuple[Floats, Floats]:
    """Mean and covariance of `LAWS`, NaN where unknown."""
    mean, cov = np.full(len(LAWS), np.nan), np.zeros((len(LAWS), len(LAWS)))
    whole = estimates.shot_fit
    alone: dict[str, Estimate] = {
        "restitution": estimates.restitution,
        "friction": estimates.friction,
    }
    at = [] if whole is None else [k for k, name in enumerate(LAWS) if whole.identifies(name)]
    if whole is not None and at:
        ranks = [whole.names.index(LAWS[k]) for k in at]
        mean[at] = whole.values[ranks]
        cov[np.ix_(at, at)] = whole.cov[np.ix_(ranks, ranks)]
    for k, name in enumerate(LAWS):
        one = alone.get(name, Estimate())
        if k not in at and one.value is not None and one.stderr is not None:
            mean[k], cov[k, k] = one.value, one.stderr**2
    return mean, cov
