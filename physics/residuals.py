"""What residuals tell of the noise: outliers, and errors that are alike from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

HUBER = 3.0
"""Normalised distance of a sighting from the fit beyond which it loses weight."""

LAGS = 0.25
"""Longest lag, relative to sightings per parameter, at which residuals are compared."""

LONGEST = 60
"""No lag as long as this is looked at."""


def huber_weights(residuals: Floats) -> Floats:
    """Weights of Huber's estimator for residuals of shape (n, 2); shape (n, 1).

    A sighting is an outlier as a whole, so that no choice of axes matters.
    """
    size = np.hypot(residuals[:, 0], residuals[:, 1])
    out: Floats = (HUBER / np.maximum(size, HUBER))[:, None]
    return out


def inflation(
    runs: Sequence[tuple[Floats, int]],
    free: float,
    alike: Sequence[tuple[Floats, int]] = (),
) -> float:
    """Factor for variances of residuals that are larger than stated, or alike in time.

    Parameters
    ----------
    runs : sequence of ((n, 2) array, int)
        Normalised residuals of each stone in order of time, and the number of parameters
        fitted to each column, about.
    free : float
        Residuals less parameters; below 1 nothing can be told.
    alike : sequence of ((n, k) array, int)
        Further residuals that only say how alike they are in time.
    """
    if free < 1:
        return 1.0
    weighted = [(run * huber_weights(run), parameters) for run, parameters in runs]
    square = sum(float(np.sum(run * run)) for run, _ in weighted)
    return max(1.0, square / free) * likeness([*weighted, *alike])


def likeness(runs: Sequence[tuple[Floats, int]]) -> float:
    """Long-run variance of residuals over their variance: 1 for white noise, never less.

    Means and slopes have errors larger by this factor than white noise would give them. The
    sum of autocorrelations runs as far as they are significant; what the fit itself took out
    of each lag (p / n of the long-run variance) is put back.

    Parameters
    ----------
    runs : sequence of ((n, k) array, int)
        Residuals in order of time, and the number of parameters fitted to each column.
    """
    runs = [(r, p) for r, p in runs if len(r) >= 8]
    if not runs:
        return 1.0
    level = sum(float(np.sum(r * r)) for r, _ in runs) / sum(r.size for r, _ in runs)
    if level <= 0:
        return 1.0
    alike: list[tuple[float, float, int]] = []
    ratio = 1.0
    for _ in range(4):
        total = 1.0
        for lag in range(1, LONGEST):
            if lag > len(alike):
                further = _alike(runs, lag, level)
                if further is None:
                    break
                alike.append(further)
            seen, lost, size = alike[lag - 1]
            correlation = seen + ratio * lost
            if correlation < 2 / np.sqrt(size):
                break
            total += 2 * correlation
        ratio = max(1.0, total)
    return ratio


def _alike(
    runs: Sequence[tuple[Floats, int]], lag: int, level: float
) -> tuple[float, float, int] | None:
    """Correlation of residuals a lag apart, as seen and as lost to the fit; None if no longer told.

    Returns
    -------
    seen, lost : float
        The second in units of the long-run variance over the variance.
    size : int
        How many products it is the mean of.
    """
    usable = [(r, p) for r, p in runs if lag <= LAGS * len(r) / p]
    if not usable:
        return None
    size = sum(r[lag:].size for r, _ in usable)
    seen = sum(float(np.vdot(r[lag:], r[:-lag])) for r, _ in usable) / level
    lost = sum(p / len(r) * r[lag:].size for r, p in usable)
    return seen / size, lost / size, size
