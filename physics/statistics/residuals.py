"""What residuals tell of the noise: outliers, and autocorrelation from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

HUBER = 3.0
"""Normalised distance of a detection from the fit beyond which it loses weight."""

LAGS = 0.25
"""Longest lag, relative to detections per parameter, at which residuals are compared."""

LONGEST = 60
"""No lag as long as this is looked at."""


def huber_weights(residuals: Floats) -> Floats:
    """Weights of Huber's estimator for residuals of shape (n, 2); shape (n, 1).

    A detection is an outlier as a whole, so that no choice of axes matters.
    """
    size = np.hypot(residuals[:, 0], residuals[:, 1])
    out: Floats = (HUBER / np.maximum(size, HUBER))[:, None]
    return out


def inflation(
    runs: Sequence[tuple[Floats, int]],
    free: float,
    further: Sequence[tuple[Floats, int]] = (),
) -> float:
    """Factor for variances of residuals that are larger than stated, or correlated in time.

    Parameters
    ----------
    runs : sequence of ((n, 2) array, int)
        Normalised residuals of each stone in order of time, and the number of parameters
        fitted to each column, about.
    free : float
        Residuals less parameters; below 1 nothing can be told.
    further : sequence of ((n, k) array, int)
        More residuals, used for their autocorrelation alone.
    """
    if free < 1:
        return 1.0
    each, parameters = zip(*runs, strict=True)
    together = np.concatenate(each)
    together = together * huber_weights(together)
    weighted = np.split(together, np.cumsum([len(run) for run in each])[:-1])
    alike = autocorrelation_factor([*zip(weighted, parameters, strict=True), *further])
    return max(1.0, float(np.sum(together * together)) / free) * alike


def autocorrelation_factor(runs: Sequence[tuple[Floats, int]]) -> float:
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
    lags = np.arange(1, LONGEST)
    counts, columns = np.array([r.shape for r, _ in runs]).T[:, :, None]
    parameters = np.array([[p] for _, p in runs])
    products = np.where(lags <= LAGS * counts / parameters, (counts - lags) * columns, 0)
    size, lost = products.sum(0), (products * parameters / counts).sum(0)
    seen = np.where(products > 0, _products([r for r, _ in runs], len(lags)), 0.0).sum(0)
    told = size > 0
    seen, lost, size = seen[told] / level / size[told], lost[told] / size[told], size[told]
    ratio = 1.0
    for _ in range(4):
        correlation = seen + ratio * lost
        weak = np.append(correlation < 2 / np.sqrt(size), True)
        ratio = max(1.0, 1.0 + 2 * float(correlation[: int(weak.argmax())].sum()))
    return ratio


def _products(runs: Sequence[Floats], most: int) -> Floats:
    """Sum the products of residuals 1, 2 … `most` apart of each run (by Fourier transforms)."""
    longest = max(len(run) for run in runs) + most
    length = 1 << (longest - 1).bit_length()  # of a prime it would take five times as long
    ends = np.cumsum([run.shape[1] for run in runs])
    padded = np.zeros((int(ends[-1]), length))
    for run, end in zip(runs, ends.tolist(), strict=True):
        padded[end - run.shape[1] : end, : len(run)] = run.T
    power = np.add.reduceat(np.abs(np.fft.rfft(padded)) ** 2, [0, *ends[:-1]])
    return np.asarray(np.fft.irfft(power, length)[:, 1 : most + 1])
