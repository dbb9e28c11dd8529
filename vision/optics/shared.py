"""Result of the bundle adjustment: what the frames of a clip share, with its covariance.

Camera place and lens, and how far each piece of a painted line lies off its nominal course: that
is the same in however many frames show it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import CIRCLES, FIXED, Marks
from curlshot.vision.optics.pose import VIEW_SIZE
from curlshot.vision.optics.rig import POSITION, RIG_SIZE

Array = NDArray[np.float64]
Index = NDArray[np.int64]

ARC, PIECE = np.radians(5.0), 0.12
"""Length of a piece of a circle, rad, and of a line, m: no more than from mark to mark. What marks
are aside stays in a picture that stays, and goes on along a line in waves: marks of one piece would
tell of a slope that is none, and draw the house aside."""

BINS = 1000
"""Pieces a line may have; the identity of a piece is its line's number times this, plus its own."""


@dataclass(frozen=True)
class Bundle:
    """What frames share.

    Attributes
    ----------
    rig : ndarray, shape (15,)
    travel : ndarray, shape (d, 3)
        Coefficients of the camera's motion; none if it stays where it is.
    span : tuple of float
        First and last time of the frames, s.
    pieces : ndarray of int, shape (c,)
        Identities of the pieces of paint, ascending (see `piece_of`).
    offset : ndarray, shape (c,)
        How far each lies off its line, m.
    cov : ndarray, shape (15 + 3 d + c, 15 + 3 d + c)
        Covariance of rig, travel and offsets.
    noise : ndarray, shape (3,)
        Standard deviation of a single mark on a circle, on a line, of a fixed point, in stated
        ones.
    cropped : bool
        Whether pictures seem to be cropped off their middle, or stretched.
    ragged : float
        How far circles lie off their course, as it was learned, a standard deviation, m.
    """

    rig: Array
    travel: Array
    span: tuple[float, float]
    pieces: Index
    offset: Array
    cov: Array
    noise: Array
    cropped: bool = False
    ragged: float = 0.0

    def moved(self, t: Array) -> Array:
        """How far the camera is from the rig's place at these times, shape (n, 3), m."""
        return polynomials(t, self.span, len(self.travel)) @ self.travel

    def covariances(self, by: Array, t: Array) -> Array:
        """Covariances at n times of what follows rig and offsets by `by`, (n, k, 15 + c): k by k.

        All at once: the matrix of all pieces is large, and is gone through once.
        """
        basis = polynomials(t, self.span, len(self.travel))
        along = (basis[:, None, :, None] * by[..., None, POSITION]).reshape(*by.shape[:2], -1)
        whole = np.concatenate([by[..., :RIG_SIZE], along, by[..., RIG_SIZE:]], axis=-1)
        spread = (whole.reshape(-1, len(self.cov)) @ self.cov).reshape(whole.shape)
        return np.asarray(spread @ np.swapaxes(whole, 1, 2))

    def offsets(self, marks: Marks) -> tuple[Array, Index]:
        """Offset of the paint under each mark, m, and the place of its piece; 0, −1 if unseen."""
        wanted = piece_of(marks)
        at = np.minimum(np.searchsorted(self.pieces, wanted), len(self.pieces) - 1)
        known = self.pieces[at] == wanted
        return np.where(known, self.offset[at], 0.0), np.where(known, at, -1)


def piece_of(marks: Marks, arc: float = ARC) -> Index:
    """Identity of the piece of paint that each mark lies on; those of circles are `arc` long."""
    length = np.where(marks.line < CIRCLES, arc, PIECE)
    number = np.floor(marks.along / length).astype(np.int64) + BINS // 2
    return np.asarray(marks.line * BINS + np.clip(number, 0, BINS - 1))


def family(line: Index) -> Index:
    """Tell circles (0), lines (1) and fixed points (2) apart."""
    return np.asarray((line >= CIRCLES).astype(np.int64) + (line == FIXED), np.int64)


def polynomials(t: Array, span: tuple[float, float], degree: int) -> Array:
    """Legendre polynomials of the 1st to this degree over a span of time, shape (n, degree)."""
    first, last = span
    share = np.clip(2 * (t - first) / max(last - first, 1e-9) - 1, -1, 1)
    found = np.ones((degree + 1, len(t)))
    for k in range(1, degree + 1):  # Bonnet's recursion
        found[k] = ((2 * k - 1) * share * found[k - 1] - (k - 1) * found[k - 2]) / k
    return found[1:].T


def sensitivity(
    by_view: Array, by_shared: Array, by_offset: Array, cov: Array, piece: Index, shared: int
) -> Array:
    """How a view follows rig and offsets when fitted with these held, shape (4, shared).

    Parameters
    ----------
    by_view : ndarray, shape (4, n)
        Derivatives of a frame's residuals, times their weights.
    by_shared, by_offset : ndarray, shapes (15, n) and (n,)
        Derivatives by the rig, and by a shift of the paint under the mark.
    cov : ndarray, shape (4, 4)
        Of the view.
    piece : ndarray of int, shape (n,)
        Which offset is that of the paint under the mark; −1 for none.
    shared : int
        How many rig and offsets are.
    """
    found = np.zeros((VIEW_SIZE, shared))
    found[:, :RIG_SIZE] = by_view @ by_shared.T
    known = piece >= 0
    mixed = (by_view * by_offset)[:, known]
    for row, values in zip(found, mixed, strict=True):
        row[RIG_SIZE:] = np.bincount(piece[known], values, shared - RIG_SIZE)
    return -cov @ found
