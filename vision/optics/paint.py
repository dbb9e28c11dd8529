"""The paint in the ice: circles and lines whose measures a rig holds, and marks seen on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.rig import BACK_Y, CENTRE_X, HOG_Y, R4, R8, SIDE_L, SIDE_R, TEE_Y

Array = NDArray[np.float64]

CIRCLES = 3
TWELVE, EIGHT, FOUR, CENTRE_LINE, TEE_LINE, LEFT, RIGHT, BACK_LINE, HOG_LINE, FIXED = range(10)
"""What a mark lies on: the three circles, the two lines through the tee, the sheet's sides, the
lines across it behind and before the house; or a point of the ice whose place is known."""


@dataclass(frozen=True)
class Marks:
    """Edge points measured in one frame.

    Attributes
    ----------
    line : ndarray of int, shape (n,)
        What each point lies on (`TWELVE` … `FIXED`).
    along : ndarray, shape (n,)
        Angle on a circle, rad; the coordinate along a line, m; x of a fixed point, m.
    pixel, normal : ndarray, shape (n, 2)
        Measured place and the unit normal along which it was measured, px.
    sd : ndarray, shape (n,)
        Standard deviation along the normal, px.
    across : ndarray, shape (n,), optional
        y of a fixed point, m; without meaning for the other kinds. None where there are no fixed
        points.
    """

    line: NDArray[np.int64]
    along: Array
    pixel: Array
    normal: Array
    sd: Array
    across: Array | None = None

    def __len__(self) -> int:
        return len(self.line)

    def pick(self, which: NDArray[np.bool_] | NDArray[np.int64]) -> Marks:
        """Pick the marks for which `which` is True, or those of these indices."""
        # By indices, and taken: half as long as each array by itself.
        at = np.flatnonzero(which) if which.dtype == bool else which
        return Marks(
            self.line.take(at),
            self.along.take(at),
            self.pixel.take(at, axis=0),
            self.normal.take(at, axis=0),
            self.sd.take(at),
            None if self.across is None else self.across.take(at),
        )


def joined(parts: Sequence[Marks]) -> Marks:
    """Join marks of several kinds into one."""
    if not parts:
        none = np.zeros((0, 2))
        return Marks(np.zeros(0, np.int64), np.zeros(0), none, none.copy(), np.zeros(0))
    return Marks(
        np.concatenate([p.line for p in parts]),
        np.concatenate([p.along for p in parts]),
        np.concatenate([p.pixel for p in parts]),
        np.concatenate([p.normal for p in parts]),
        np.concatenate([p.sd for p in parts]),
        None
        if all(p.across is None for p in parts)
        else np.concatenate([np.zeros(len(p)) if p.across is None else p.across for p in parts]),
    )


def fixed(ice: Array, pixel: Array, sd: ArrayLike) -> Marks:
    """Points of the ice at known places, shape (n, 2), m, seen at pixels: two marks for each."""
    count = len(ice)
    x, y = np.concatenate([ice, ice]).T
    normal, both = np.zeros((2 * count, 2)), np.empty((2, count))
    normal[:count, 0] = normal[count:, 1] = 1.0
    both[:] = sd
    return Marks(
        np.full(2 * count, FIXED), x, np.concatenate([pixel, pixel]), normal, both.ravel(), y
    )


MEASURED = np.array([-1, R8, R4, CENTRE_X, TEE_Y, SIDE_L, SIDE_R, BACK_Y, HOG_Y, -1])
"""Per kind of mark the unknown of the rig that is its measure; −1 where that is known."""


def measures(rig: Array) -> Array:
    """List the measure of each kind of mark: radius of a circle or place of a line, m."""
    found = np.zeros(len(MEASURED))
    found[TWELVE] = HOUSE.twelve_foot
    found[1:-1] = rig[MEASURED[1:-1]]
    return found


_FACTORS = np.zeros((4, 10))
_FACTORS[0, :CIRCLES] = 1.0  # circles
_FACTORS[1, [CENTRE_LINE, LEFT, RIGHT]] = 1.0  # lines along the sheet
_FACTORS[2, [TEE_LINE, BACK_LINE, HOG_LINE]] = 1.0  # lines across it
_FACTORS[3, FIXED] = 1.0


def ice_frame(
    line: NDArray[np.int64], along: Array, across: Array | None = None
) -> tuple[Array, Array]:
    """Foot of each mark and the direction in which its line's measure moves it, (2, n) each."""
    circle, lengthwise, crosswise, known = _FACTORS[:, line]
    foot, way = np.empty((2, len(line))), np.empty((2, len(line)))
    way[0] = circle * np.cos(along) + lengthwise
    way[1] = circle * np.sin(along) + crosswise
    foot[0] = (crosswise + known) * along
    foot[1] = lengthwise * along
    if across is not None:
        foot[1] += known * across
    return foot, way
