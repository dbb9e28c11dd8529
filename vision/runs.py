"""Runs of measurements along lines, all lines at once: padded to a table, a row for each line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

APART = 2.5
"""Standard deviations from a smooth curve beyond which an offset is left out."""

_TERMS = 3
_HELD = 1e9


@dataclass(frozen=True)
class Runs:
    """Where the members of each run lie in a list.

    Attributes
    ----------
    index : ndarray of int, shape (runs, longest)
        Places in the list; that of the last member is repeated to the end of the row.
    real : ndarray of bool, shape (runs, longest)
        False for repetitions.
    """

    index: Index
    real: Flags

    @classmethod
    def of(cls, parts: Sequence[slice]) -> Runs:
        """Make a table of these parts of a list; none of them may be empty."""
        start, stop = np.array([(part.start, part.stop) for part in parts]).T[..., None]
        index = start + np.arange((stop - start).max())
        return cls(np.minimum(index, stop - 1), index < stop)


def smooth(along: Array, offset: Array, good: Flags, least_sd: float) -> tuple[Flags, Array]:
    """Leave out what lies off smooth curves through offsets; what is ragged counts less.

    Parameters
    ----------
    along, offset : ndarray, shape (runs, longest)
        Place along each line, m, and how far aside its image was found, px.
    good : ndarray of bool, shape (runs, longest)
        What is looked at.
    least_sd : float
        Least standard deviation, px.

    Returns
    -------
    keep, sd : ndarray, shapes (runs, longest) and (runs,)
        What is left, and its standard deviation in each run, px.
    """
    s = along - along.mean(1, keepdims=True)
    s /= np.maximum(np.ptp(s, axis=1, keepdims=True), 1e-9)
    terms = np.stack([np.ones_like(s), s, s * s], axis=1)
    offset, keep = offset[..., None], good
    for _ in range(2):
        count = keep.sum(1)
        weighted = terms * keep[:, None]
        # Few points do not bend a line: two for each term of the curve.
        held = np.where(count[:, None] // 2 > np.arange(_TERMS), 1e-9, _HELD)
        held[:, 0] = 1e-9
        normal = weighted @ terms.swapaxes(1, 2) + held[:, None] * np.eye(_TERMS)
        curve = np.linalg.solve(normal, weighted @ offset)
        away = np.abs(offset - terms.swapaxes(1, 2) @ curve)[..., 0]
        ranked = np.sort(np.where(keep, away, np.inf), axis=1)
        middle = ranked[np.arange(len(ranked)), np.maximum(count // 2, 0)]
        sd = np.maximum(1.5 * np.where(count > 0, middle, 0.0), least_sd)
        keep = good & (away < APART * sd[:, None])
    return keep, sd
