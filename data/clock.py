"""The equal steps of time from which printed times were rounded."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from curlshot.data.tracks import LATEST

Array = NDArray[np.float64]


def with_clock(
    table: pd.DataFrame, decimals: Sequence[int | None]
) -> tuple[pd.DataFrame, float | None]:
    """Give the rows the equal time steps that their printed times were rounded from.

    Parameters
    ----------
    table : DataFrame
        With a column ``t``, s, and possibly ``frame``.
    decimals : sequence of (int or None)
        To how many decimals the times of each file are printed; None where that is open.

    Returns
    -------
    DataFrame
        With ``frame`` where steps are equal.
    float or None
        Rate of the rows, 1/s; None where there is only one time.
    """
    t = table["t"].to_numpy(float)
    if not np.isfinite(t).all() or np.abs(t).max() > LATEST:
        return table, None  # to be refused with its reason
    times, rank = np.unique(t, return_inverse=True)
    if len(times) < 2:
        return table, None
    printed = max((d for d in decimals if d is not None), default=None)
    count, start, step = uniform_steps(times)
    even = start + step * count
    off = float(np.abs(even - times).max())
    rounding = 0.75 * 10.0**-printed if printed is not None else 0.0
    explained = off < rounding < 0.3 * step
    uniform = explained or off < 0.05 * step
    if explained and off > 1e-6 * step:
        # Equal steps explain the printed times: the rounding goes.
        table = table.assign(t=even[rank])
    frame = table["frame"] if "frame" in table else pd.Series(np.nan, index=table.index)
    if frame.isna().any() and uniform:
        table = table.assign(frame=count[rank])
    elif frame.isna().any() and "frame" in table:
        table = table.drop(columns="frame")
    typical = step if uniform else float(np.median(np.diff(times)))
    return table, float(f"{1 / typical:.9g}")


def uniform_steps(times: Array) -> tuple[Array, float, float]:
    """Fit equal steps to increasing times, of which some may be missing.

    Parameters
    ----------
    times : ndarray, shape (n,)
        At least two times, s.

    Returns
    -------
    count : ndarray, shape (n,)
        Number of steps since the first time.
    start, step : float
        So that ``start + step * count`` fits best, s.
    """
    steps = np.diff(times)
    short = float(np.median(steps[steps < 1.5 * steps.min()]))
    count = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(steps / short), 1))])
    centred = count - count.mean()
    with np.errstate(over="ignore"):  # times a hair apart among others: no equal steps
        step = float((centred * (times - times.mean())).sum() / (centred**2).sum())
    return count, float(times.mean() - step * count.mean()), step
