"""Motion of the picture from one frame to the next."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

FLOW_WIDTH = 480
"""Width of the pictures in which motion is measured, px."""


def _thumbnail(image: Image) -> Image:
    """Small grey picture that `similarity` works on."""
    factor = FLOW_WIDTH / image.shape[1]
    small = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.cvtColor(small, cv2.COLOR_BGR2GRAY), np.uint8)


def similarity(before: Image, after: Image) -> Array | None:
    """How the picture moved: shape (2, 3), px; None where the two do not show the same scene.

    Corners are followed from one thumbnail to the next and back; most of the picture must move
    as one.
    """
    width = before.shape[1]
    before, after = _thumbnail(before), _thumbnail(after)
    corners = cv2.goodFeaturesToTrack(before, 200, 0.01, 8)
    if corners is None or len(corners) < 12:
        return None
    there, ok, _ = cv2.calcOpticalFlowPyrLK(before, after, corners, corners.copy())
    back, ok_back, _ = cv2.calcOpticalFlowPyrLK(after, before, there, there.copy())
    error = np.linalg.norm((back - corners).reshape(-1, 2), axis=1)
    good = (ok.ravel() == 1) & (ok_back.ravel() == 1) & (error < 1.0)
    if good.sum() < max(10, 0.35 * len(corners)):
        return None
    matrix, inlier = cv2.estimateAffinePartial2D(
        corners[good], there[good], ransacReprojThreshold=1.0
    )
    if matrix is None or inlier.sum() < max(8, 0.5 * good.sum()):
        return None
    matrix = np.asarray(matrix, float)
    if not 0.8 < np.hypot(matrix[0, 0], matrix[1, 0]) < 1.25:
        return None
    scale = width / FLOW_WIDTH
    # A resized picture's pixel centres: X = (x + 1/2) s − 1/2.
    shift = (scale - 1) / 2
    matrix[:, 2] = scale * matrix[:, 2] + shift - matrix[:, :2] @ np.full(2, shift)
    return matrix
