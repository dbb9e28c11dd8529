"""Camera motion by optical flow: turn, roll and zoom from picture to picture, by tracked corners.

A shaken camera cannot be predicted by how it moved before. Corners, followed in small pictures,
tell to a few pixels where it looks now: near enough for edges to be measured there.
Lucas and Kanade, 1981, An iterative image registration technique, IJCAI 81, pages 674 to 679.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.camera_path.keyframe import small_of
from curlshot.vision.optics.pose import DOWN, View, rotation_vector
from curlshot.vision.video.picture import Picture

Array = NDArray[np.float64]

WIDEST = 480
"""Width of the small pictures at most, px."""

MOST_CORNERS, APART, LEAST_RESPONSE = 40, 10, 1e-3
"""Corners, their least distance, px of the small picture, and their least response as a share of
the strongest one's (Harris and Stephens, 1988)."""

WINDOW, LEVELS = (15, 15), 3
TERMINATION = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 8, 0.03)
"""Window, levels of the pyramid and end of the search for a corner."""

TOGETHER_PX, LEAST_TOGETHER, LEAST_SHARE = 1.5, 8, 0.5
"""Corners move as one within so many px of the small picture; so many of them and this share of
those that were followed must."""


def foretold(before: Picture, view: View, pictures: Sequence[Picture]) -> list[View]:
    """Predict the views of consecutive pictures by optical flow from one to the next.

    Parameters
    ----------
    before, view : Picture, View
        The picture before them, and its view.
    pictures : sequence of Picture

    Returns
    -------
    list of View
        Of the first of them, up to one that does not show the same scene.
    """
    last = small_of(before, WIDEST)
    factor = before.shape[1] / last.shape[1]
    corners = cv2.goodFeaturesToTrack(
        last, MOST_CORNERS, LEAST_RESPONSE, APART, useHarrisDetector=True
    )
    views: list[View] = []
    for picture in pictures:
        if corners is None or len(corners) < LEAST_TOGETHER:
            break
        now = small_of(picture, WIDEST)
        there, ok, _ = cv2.calcOpticalFlowPyrLK(
            last, now, corners, np.zeros_like(corners), winSize=WINDOW, maxLevel=LEVELS,
            criteria=TERMINATION,
        )  # fmt: skip
        good = ok.ravel() == 1
        corners, there = corners[good], there[good]
        if len(there) < LEAST_TOGETHER:
            break
        motion, together = cv2.estimateAffinePartial2D(
            corners, there, ransacReprojThreshold=TOGETHER_PX, refineIters=2
        )
        if motion is None or together.sum() < max(LEAST_TOGETHER, LEAST_SHARE * len(there)):
            break
        view = turned(view, np.asarray(motion), factor, now.shape)
        views.append(view)
        corners, last = there[together.ravel() == 1], now
    return views


def turned(view: View, motion: Array, factor: float, shape: tuple[int, ...]) -> View:
    """Turn, roll and zoom a view as its picture has moved.

    Parameters
    ----------
    view : View
    motion : ndarray, shape (2, 3)
        How places in a picture `factor` times smaller have moved: turn, stretch and shift.
    factor : float
    shape : tuple of int
        Height and width of the small picture, px.
    """
    middle = np.array([(shape[1] - 1) / 2, (shape[0] - 1) / 2])
    across, down = factor * (motion @ [*middle, 1.0] - middle) / view.focal
    roll = np.arctan2(motion[1, 0], motion[0, 0])
    turn = np.asarray(cv2.Rodrigues(np.array([-np.arctan(down), np.arctan(across), roll]))[0])
    vector = rotation_vector(turn @ view.rotation @ DOWN.T)
    stretch = float(np.log(np.hypot(motion[0, 0], motion[1, 0])))
    return View(np.append(vector, view.vector[3] + stretch))
