"""Camera motion too fast to be tracked: the shift of the whole picture, by template matching."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.camera_path.keyframe import small_of
from curlshot.vision.optics.paint import fixed
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.optics.resection import solve_view
from curlshot.vision.video.picture import Image, Picture

Array = NDArray[np.float64]

WIDE = 160
"""Width of the pictures compared, px: in these the blur of a pan is a few pixels, and all that is
to be told is which way to look."""

MIDDLE = 3
"""The middle of the picture before, this part of it along each side, is looked for: a pan of less
than a third of the picture keeps it in view."""

LIKE = 0.8
"""Least correlation at which it is the same: in pans it is above 0.9."""

HELD = (np.inf, np.inf, 1e-3, 1e-3)
"""A camera that turns fast neither rolls nor zooms at once by much."""


def leapt(before: Picture, now: Picture, view: View, rig: Array) -> View | None:
    """Predict a view from the shift of the whole picture.

    Parameters
    ----------
    before, now : Picture
        The picture of the view, and the next one.
    view, rig : View, ndarray of shape (15,)
        The camera of the picture before.

    Returns
    -------
    View or None
        None where the picture does not show the same scene.
    """
    height, width = before.shape[:2]
    shift = _shift(_coarse(before), _coarse(now))
    if shift is None:
        return None
    down, across = np.mgrid[1:MIDDLE, 1:MIDDLE].reshape(2, -1) / MIDDLE
    pixels = np.stack([across * (width - 1), down * (height - 1)], axis=-1)
    ice = camera(view, rig, (width, height)).ice(pixels)
    aim = fixed(ice, pixels + shift * (width / WIDE), 1.0)
    return solve_view(aim, view, rig, (width, height), view_sd=HELD, width=1e4).view


def _coarse(picture: Picture) -> Image:
    grey = small_of(picture)
    size = WIDE, round(WIDE * grey.shape[0] / grey.shape[1])
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), np.uint8)


def _shift(before: Image, now: Image) -> Array | None:
    """How far the middle of a picture has moved in another, px; None where it is not in it."""
    y, x = (side // MIDDLE for side in before.shape)
    middle = before[y:-y, x:-x]
    if np.ptp(middle) == 0:
        return None  # bare ice: OpenCV would find it anywhere
    found = cv2.matchTemplate(now, middle, cv2.TM_CCOEFF_NORMED)
    _, best, _, at = cv2.minMaxLoc(found)
    return np.array([at[0] - x, at[1] - y], float) if best > LIKE else None
