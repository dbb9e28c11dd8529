"""Outliers along straight lines, by robust parabolas: all lines at once, a padded row for each."""

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
"""Of a parabola."""

_DIAGONAL = np.eye(_TERMS)
_LEAST_POINTS = np.array([-1, 3, 5])
"""A term of the curve takes part if there are more points."""

_HELD, _FREE = 1e9, 1e-12
"""What holds a term at 0 that does not take part: more than any line has points; and one that does,
so that points at one place have a curve too: by no more than rounding."""


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
        ends = np.array([(part.start, part.stop) for part in parts], np.int64).reshape(-1, 2)
        start, stop = ends.T[..., None]
        index = start + np.arange((stop - start).max(initial=1))
        return cls(np.minimum(index, stop - 1), index < stop)


@dataclass(frozen=True)
class Curves:
    """Parabolas that may run along lines.

    Attributes
    ----------
    terms : ndarray, shape (runs, 3, longest)
        Their values where each line was measured.
    squares : ndarray, shape (runs, longest, 9)
        Products of any two of them.
    """

    terms: Array
    squares: Array

    @classmethod
    def along(cls, along: Array) -> Curves:
        """Prepare curves through these places along each line, m, shape (runs, longest)."""
        s = along - along.mean(1, keepdims=True)
        s /= np.maximum(np.ptp(s, axis=1, keepdims=True), 1e-9)
        terms = np.stack([np.ones_like(s), s, s * s], axis=1)
        squares = terms[:, :, None] * terms[:, None]
        return cls(terms, squares.reshape(len(s), _TERMS**2, s.shape[1]).swapaxes(1, 2))


def smooth(curves: Curves, offset: Array, good: Flags, least_sd: float) -> tuple[Flags, Array]:
    """Reject outliers from parabolas fitted robustly along each line, and estimate its noise.

    Parameters
    ----------
    curves : Curves
    offset : ndarray, shape (..., runs, longest)
        How far aside the image of each line was found, px, in one or more pictures.
    good : ndarray of bool, shape (..., runs, longest)
        What is looked at.
    least_sd : float
        Least standard deviation, px.

    Returns
    -------
    keep, sd : ndarray, shapes (..., runs, longest) and (..., runs)
        What is left, and its standard deviation in each run, px.
    """
    runs = offset.shape[:-1]
    pull, keep = curves.terms * offset[..., None, :], good
    for _ in range(2):
        use = keep.astype(np.float64)[..., None]
        count = keep.sum(-1)[..., None]
        # Few points do not bend a line: two for each term of the curve.
        held = np.where(count > _LEAST_POINTS, _FREE, _HELD)
        normal = (use.swapaxes(-1, -2) @ curves.squares).reshape(*runs, _TERMS, _TERMS)
        normal += held[..., None] * _DIAGONAL
        curve = np.linalg.solve(normal, pull @ use)
        away = np.abs(offset - (curve.swapaxes(-1, -2) @ curves.terms)[..., 0, :])
        ranked = np.sort(np.where(keep, away, np.inf), axis=-1)
        middle = np.take_along_axis(ranked, count // 2, -1)
        sd = np.maximum(1.5 * np.where(count > 0, middle, 0.0), least_sd)
        keep = good & (away < APART * sd)
    return keep, sd[..., 0]
