"""The error that places share: a random field on the ice, alike at places near each other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.traces import Trace, shared_correlation

Floats = NDArray[np.float64]

GROUPS = 400
"""Most groups of neighbouring detections per axis whose shared error is followed up."""

MEDIAN = 0.4549
"""Median of the square of a standard normal number."""


def shared_error(
    traces: Mapping[str, Trace], residuals: Floats, slopes: Floats, cov: Floats, weights: Floats
) -> Floats:
    """Covariance of a fit's unknowns due to the error that places share.

    The map of the ice is off by a random field whose correlation falls with the distance
    (`curlshot.physics.local_fit.traces.shared_correlation`), and the unknowns follow it as they
    follow the detections. Its variance is the mean of what is stated, `sd_place` squared, and of
    what the residuals show, as far as noise does not hide it.

    Parameters
    ----------
    traces : mapping
        Detections of each stone.
    residuals : (n, 2) array
        Sighted less fitted places over their standard deviations, in the order of the traces.
    slopes : (2 n, m) array
        Derivatives of the residuals by the unknowns.
    cov : (m, m) array
        Covariance of the unknowns from errors that are anew in each detection.
    weights : (2 n,) array
        Of the residuals in the fit.

    Returns
    -------
    (m, m) array
        To be added to `cov`.
    """
    size = np.concatenate([trace.sd_place for trace in traces.values()])
    if not size.any():
        return np.zeros_like(cov)
    sd = np.concatenate([trace.sd for trace in traces.values()])
    xy = np.concatenate([trace.xy for trace in traces.values()])
    edges = np.linspace(0, len(xy), min(GROUPS, len(xy)), endpoint=False).astype(int)
    counts = np.diff(np.append(edges, len(xy)))

    def mean(values: Floats) -> Floats:
        return np.asarray(
            np.add.reduceat(values, edges) / counts.reshape(-1, *[1] * (values.ndim - 1))
        )

    gain = (-(cov @ slopes.T) * weights).reshape(len(cov), -1, 2) / sd * size
    sums = np.add.reduceat(gain, edges, axis=1)
    middle = mean(xy)
    correlation = shared_correlation(middle)
    field = [sums[:, :, axis] @ correlation for axis in range(2)]
    out = sum(field[axis] @ sums[:, :, axis].T for axis in range(2))
    # What the fit leaves of such a field, group by group.
    off = residuals * sd
    bent = mean(slopes.reshape(len(xy), 2, -1) * sd[:, :, None])
    left = np.stack(
        [
            mean(size)[:, axis] ** 2
            + 2 * mean(size)[:, axis] * np.einsum("gm,mg->g", bent[:, axis], field[axis])
            + np.einsum("gm,mk,gk->g", bent[:, axis], out, bent[:, axis])
            for axis in range(2)
        ],
        axis=1,
    )
    steps = np.diff(off, axis=0)
    noise = np.median(steps**2, axis=0) / MEDIAN / 2 / counts[:, None]
    return np.asarray(out * (1 + _shown(mean(off), left, noise)) / 2)


def _shown(off: Floats, left: Floats, noise: Floats) -> float:
    """Factor on the variances `left` that residuals show, shrunk to 1 as far as noise hides them.

    A fit follows a field over a short path and leaves next to nothing of it: whatever else
    residuals have in them would pass for a field many times as large.
    """
    told = float(np.mean(left / (left + noise)))
    return told * _excess(off, left, noise) + 1 - told


def _excess(off: Floats, left: Floats, noise: Floats) -> float:
    """Factor on the variances `left` with which, and with noise, residuals scatter as they do.

    By the median, so that outliers do not decide.
    """
    low, high = 0.0, 1e4
    for _ in range(60):
        factor = (low + high) / 2
        if np.median(off**2 / (factor * left + noise)) > MEDIAN:
            low = factor
        else:
            high = factor
    return high
