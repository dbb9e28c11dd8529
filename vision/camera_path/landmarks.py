"""Landmarks: corners of a keyframe found again in later pictures, where no rings are in view.

A keyframe is warped to where the next camera is expected and compared with what is seen there,
so that errors do not add up from frame to frame but only from keyframe to keyframe. People,
moving stones and graphics do not move as the ice does and are left out.
Lucas and Kanade, 1981, An iterative image registration technique, IJCAI 81, pages 674 to 679.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.camera_path.keyframe import Keyframe, enlarged, shrunk, small_of
from curlshot.vision.optics.paint import Marks, fixed
from curlshot.vision.optics.pose import View, project
from curlshot.vision.video.picture import Image, Picture

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

CORNER_SD = 0.3
"""Standard deviation of a recognised corner per axis, px of the small picture."""

WINDOW, LEVELS = (15, 15), 2
"""Window and levels of the pyramid in which a corner is followed."""

ALIKE = 0.02
"""Turn or stretch up to which a window looks the same: by a seventh of a pixel at its corners."""

RIM, MOST_BACK = 3.0, 1.0
"""How near the rim of the small picture no corner is followed; how far from where it came from it
may be found again, px of the small picture."""

TERMINATION = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 12, 0.02)
"""When it has been followed: steps at most, and the last step, px of the small picture."""

LEAST_CORNERS = 12
LEAST_SHARE = 0.35
"""Of the corners that should be in view, so many must be recognised and move as one."""

CELLS = (6, 4)
LEAST_CELLS = 5
"""Recognised corners must lie in so many cells of the picture: a graphic fills one or two."""


@dataclass(frozen=True)
class Recognised:
    """Landmarks found again in a picture.

    Attributes
    ----------
    marks : Marks
        Where they are.
    aside : float
        How far all of them together are from where they were expected, px.
    """

    marks: Marks
    aside: float


class Landmarks:
    """The corners of a keyframe, looked for in other pictures.

    The keyframe is warped anew only where it would look otherwise: what has merely moved is
    found all the same.
    """

    def __init__(self, key: Keyframe) -> None:
        self.key = key
        self._grey, self._corners = key.grey, key.corners
        self._shown = _within(key.corners, key.grey)

    def find(self, picture: Picture, view: View, rig: Array) -> Recognised | None:
        """Find the landmarks in a picture.

        Parameters
        ----------
        picture : Picture
        view, rig : View, ndarray
            The picture's camera, as far as it is known: within a tenth of the picture.

        Returns
        -------
        Recognised or None
            None where the picture does not show the same scene.
        """
        h, w = picture.shape[:2]
        grey = small_of(picture)
        factor = w / grey.shape[1]
        size = np.array([grey.shape[1], grey.shape[0]])
        expected = shrunk(project(self.key.ice, view.vector, rig, (w, h)), factor)
        with np.errstate(invalid="ignore"):
            near = np.flatnonzero(((expected > -0.2 * size) & (expected < 1.2 * size)).all(1))
        if len(near) < LEAST_CORNERS:
            return None
        there = expected[near]
        self._look_from(near, there)
        one = self._corners[near]
        two, good = _followed(self._grey, grey, one, there)
        if len(good) < LEAST_CORNERS:
            return None
        motion, together = cv2.estimateAffinePartial2D(
            one[good], two[good], ransacReprojThreshold=1.5, refineIters=0
        )
        if motion is None:
            return None
        kept = good[together.ravel() == 1]
        due = int(_within(one @ motion[:, :2].T + motion[:, 2], grey).sum())
        column, row = (two[kept] / size * CELLS).astype(np.int64).T
        cells = np.count_nonzero(np.bincount(column + CELLS[0] * row))
        if len(kept) < max(LEAST_CORNERS, LEAST_SHARE * due) or cells < LEAST_CELLS:
            return None
        return Recognised(
            fixed(self.key.ice[near[kept]], enlarged(two[kept], factor), CORNER_SD * factor),
            factor * float(np.abs((two - there)[kept].mean(0)).max()),
        )

    def _look_from(self, near: Index, there: Array) -> None:
        """Warp the keyframe to where its corners are due now, if it does not look like that."""
        lost = ~self._shown[near] & _within(there, self._grey)
        if not lost.any() and _alike(_affine(self._corners[near], there)):
            return
        key = self.key
        warp = _affine(key.corners[near], there)
        self._grey, self._corners = key.grey, key.corners
        if not _alike(warp):
            shown = key.grey.shape[::-1]
            warped = cv2.warpAffine(key.grey, warp, shown, borderMode=cv2.BORDER_REPLICATE)
            self._grey = np.asarray(warped, np.uint8)
            self._corners = key.corners @ warp[:, :2].T + warp[:, 2]
        self._shown = _within(self._corners, self._grey)


def _followed(before: Image, now: Image, one: Array, expected: Array) -> tuple[Array, Index]:
    """Follow corners from one picture to another; where they are, and which of them went well."""
    start = one.astype(np.float32)
    end, ok, _ = cv2.calcOpticalFlowPyrLK(
        before, now, start, expected.astype(np.float32), winSize=WINDOW, maxLevel=LEVELS,
        criteria=TERMINATION, flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )  # fmt: skip
    # What is the same is found again from there: it was there that one looked, so near at hand.
    back, ok_back, _ = cv2.calcOpticalFlowPyrLK(
        now, before, end, start.copy(), winSize=WINDOW, maxLevel=0,
        criteria=TERMINATION, flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )  # fmt: skip
    two = end.astype(np.float64)
    good = ((ok == 1) & (ok_back == 1)).ravel() & _within(two, now)
    good &= np.abs(back - start).max(1) < MOST_BACK
    return two, np.flatnonzero(good)


def _within(corners: Array, grey: Image) -> Flags:
    """Which corners lie in a small picture, not at its very rim."""
    x, y = corners.T
    height, width = grey.shape
    return np.asarray((x > RIM) & (y > RIM) & (x < width - 1 - RIM) & (y < height - 1 - RIM))


def _alike(warp: Array) -> bool:
    """Whether a window looks the same after an affine motion, apart from where it is."""
    return bool(np.abs(warp[:, :2] - np.eye(2)).max() < ALIKE)


def _affine(start: Array, end: Array) -> Array:
    """Affine motion from places to places, (n, 2) each, by least squares, shape (2, 3)."""
    middle, aim = start.mean(0), end.mean(0)
    away = start - middle
    # Held by a pixel or two: corners in one row tell of no turn across it.
    turn = np.linalg.solve(away.T @ away + np.eye(2), away.T @ end + np.eye(2)).T
    return np.column_stack([turn, aim - turn @ middle])
