"""What the frames of a clip share: the camera's place, its lens, and the measures of the paint.

The rig is an array of fifteen numbers; a `Prior` says what is known of them beforehand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import SHEET

Array = NDArray[np.float64]
Log = TypeVar("Log", float, Array)

POSITION, K1, K1_ZOOM, K2, R8, R4, SIDE_L, SIDE_R = slice(0, 3), 3, 4, 5, 6, 7, 8, 9
CENTRE_X, TEE_Y, BACK_Y, HOG_Y, K1_BEND = 10, 11, 12, 13, 14
RIG_SIZE = 15
"""Where each of its numbers lies in a rig; see `Prior`."""

HEIGHT_SD = 0.1
"""How well somebody who says it knows how high a camera hangs, m."""


BEND_OF_BEND = 0.01
"""How near to k1² the k2 of a wide lens is: with four cameras of clubs 0.009 less to 0.003 more.
Circles alone hardly tell the two apart, and what is far from them was centimetres off."""

BENT, SURELY_BENT = -0.1, -0.12
"""k1 from which on a lens is a wide one, and at which it surely is none of those of broadcasts, two
standard deviations away: of these it was −0.11 to 0.06."""


@dataclass(frozen=True)
class Prior:
    """Gaussian prior of the rig: mean and standard deviation, shape (15,) each.

    Order: position x, y, z (m); k1, its change per unit of log focal length, k2; radii of the
    8-ft and 4-ft edges (m); x of the left and the right side of the sheet, x of the centre line,
    y of the tee line, of the back line and of the hog line (m); k1 per squared unit of log focal
    length. ``height`` is how high the camera hangs, m, where somebody says it.
    """

    mean: Array
    sd: Array
    height: float | None = None

    def at_height(self, height: float | None) -> Prior:
        """Give that of a camera of which somebody says how high it hangs, m; itself if nobody."""
        if height is None:
            return self
        return replace(self._with_height(height, HEIGHT_SD), height=height)

    def as_found(self, height: float) -> Prior:
        """Give that of a camera of which nobody says how high it hangs, m; itself if nobody did."""
        if self.height is None:
            return self
        return replace(self._with_height(height, float(ANYWHERE.sd[POSITION][2])), height=None)

    def anywhere(self) -> Prior:
        """Give that of a camera with such a lens, over such a house, that may be anywhere."""
        mean, sd = ANYWHERE.mean.copy(), ANYWHERE.sd.copy()
        own = [K1, K2, BACK_Y, HOG_Y]
        mean[own], sd[own] = self.mean[own], self.sd[own]
        return Prior(mean, sd).at_height(self.height)

    def wide(self, k1: float) -> Prior:
        """Give that of a camera over such a house whose lens is a wide one and bends by about k1.

        k2 goes with it, see `BEND_OF_BEND`.
        """
        mean, sd = WIDE.mean.copy(), WIDE.sd.copy()
        own = [BACK_Y, HOG_Y]
        mean[own], sd[own] = self.mean[own], self.sd[own]
        mean[K2], sd[K2] = k1 * k1, BEND_OF_BEND
        return Prior(mean, sd).at_height(self.height)

    def downwards(self) -> Prior:
        """Give that of a house whose hog line is towards −y: stones come up the picture."""
        mean = self.mean.copy()
        mean[[BACK_Y, HOG_Y]] *= -1
        return replace(self, mean=mean)

    def _with_height(self, height: float, height_sd: float) -> Prior:
        mean, sd = self.mean.copy(), self.sd.copy()
        mean[POSITION][2], sd[POSITION][2] = height, height_sd
        return replace(self, mean=mean, sd=sd)


_LENS = ((-0.015, 0.05), (0.0, 0.05), (0.01, 0.02))  # k1, k1 by zoom, k2: broadcast lenses
_WIDE_LENS = ((-0.15, 0.1), (0.0, 0.05), (0.03, 0.03))  # of five cameras of clubs
_RADII = ((1.2135, 0.005), (0.619, 0.006))  # measured on fourteen painted houses
_SIDES = ((-2.35, 0.1), (2.35, 0.1))
_CROSS = ((0.0, 0.008), (0.0, 0.008))  # a line may be two stripes, of which one is measured
_ACROSS = ((-SHEET.back_line, 0.015), (SHEET.hog_line, 0.06))  # of a wide line one edge may be
_BEND = (0.0, 0.03)  # half the change by zoom, if k1 goes with the focal length itself


def _prior(*position: tuple[float, float], lens: tuple[tuple[float, float], ...] = _LENS) -> Prior:
    rows = np.array([*position, *lens, *_RADII, *_SIDES, *_CROSS, *_ACROSS, _BEND])
    return Prior(rows[:, 0].copy(), rows[:, 1].copy())


OVERHEAD = _prior((0.0, 0.35), (0.0, 0.35), (8.5, 1.5))
"""Broadcast cameras hang 6 to 11 m above the ice, within 0.5 m of plumb over the tee."""

ANYWHERE = _prior((0.0, 8.0), (0.0, 12.0), (7.0, 5.0))
"""A camera of which nothing is known but that it is above the ice."""

WIDE = _prior((0.0, 8.0), (0.0, 12.0), (6.0, 2.0), lens=_WIDE_LENS)
"""A camera with a wide lens, as clubs have them under the roof: k1 of five was −0.15 to −0.28."""


def with_lens(prior: Prior, k1: float) -> Prior:
    """Give that of a camera with a lens that bends so much; wide ones have a k2 of some k1²."""
    mean, sd = prior.mean.copy(), prior.sd.copy()
    mean[[K1, K2]], sd[[K1, K2]] = (k1, k1 * k1), (0.004, 0.015)
    return replace(prior, mean=mean, sd=sd)


def distortion(rig: Array, log_f: float, size: tuple[int, int]) -> tuple[float, float]:
    """Radial terms k1, k2 at a focal length; k1 goes with the zoom."""
    z = zoom(log_f, size)
    return float(rig[K1] + z * (rig[K1_ZOOM] + z * rig[K1_BEND])), float(rig[K2])


def zoom(log_f: Log, size: tuple[int, int]) -> Log:
    """Log focal length over twice the picture's width: 0 in the midst of what is usual."""
    return log_f - math.log(2.0 * size[0])


def start_rig(prior: Prior, position: ArrayLike | None = None) -> Array:
    """Start at the prior's mean, at another position if given."""
    rig = prior.mean.copy()
    if position is not None:
        rig[POSITION] = position
    return rig
