"""Points of the ice recognised again: what carries the camera where no rings are to be seen.

A keyframe is a small grey picture with corners whose places on the ice are known from its
camera. It is warped to where the next camera is expected and compared with what is seen there,
so that errors do not add up from frame to frame but only from keyframe to keyframe. People,
moving stones and graphics do not move as the ice does and are left out.
Lucas and Kanade, 1981, An iterative image registration technique, IJCAI 81, pages 674 to 679.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.camera import Camera
from vision.paint import FIXED, Marks, fixed
from vision.picture import Image, Picture, Planes
from vision.pose import View, camera, project

Array = NDArray[np.float64]

WIDEST = 800
"""Width of the small pictures at most, px: a picture is halved until it is as small."""

MOST_CORNERS = 100
APART = 10
"""Corners of a keyframe, and their least distance, px of the small picture."""

LEAST_RESPONSE = 1e-4
"""Least response of a corner, of the strongest one's (Harris and Stephens, 1988, A combined corner
and edge detector, Alvey Vision Conference): along the edges of lines points would slide."""

CORNER_SD = 0.3
"""Standard deviation of a recognised corner per axis, px of the small picture."""

WINDOW, LEVELS = (15, 15), 2
"""Window and levels of the pyramid in which a corner is followed."""

ALIKE = 0.02
"""Turn or stretch up to which a window looks the same: by a seventh of a pixel at its corners."""

TERMINATION = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 12, 0.02)
"""When it has been followed: steps at most, and the last step, px of the small picture."""

LEAST_CORNERS = 12
LEAST_SHARE = 0.35
"""Of the corners that should be in view, so many must be recognised and move as one."""

CELLS = (6, 4)
LEAST_CELLS = 5
"""Recognised corners must lie in so many cells of the picture: a graphic fills one or two."""

ICE = np.array([[-7.0, -6.0], [7.0, -6.0], [7.0, 12.0], [-7.0, 12.0]])
"""Where landmarks are looked for: this sheet and its neighbours, m."""


@dataclass(frozen=True)
class Keyframe:
    """A small picture of known camera.

    Attributes
    ----------
    frame : int
        Index of its frame in the clip.
    view, rig : View, ndarray
        Its camera when the places were worked out.
    grey : ndarray of uint8
    ice : ndarray, shape (n, 2)
        Places of its corners on the ice, m.
    corners : ndarray, shape (n, 2)
        The corners in the small picture, px.
    drift : float
        Standard deviation that the places share, m.
    """

    frame: int
    view: View
    rig: Array
    grey: Image
    ice: Array
    corners: Array
    drift: float


def keyframe(
    frame: int, picture: Picture, view: View, rig: Array, cov: Array, drift: float = 0.0
) -> Keyframe:
    """Make a keyframe of a picture.

    Parameters
    ----------
    frame, picture : int, Picture
        The picture, and the index of its frame.
    view, cov : View, ndarray of shape (4, 4)
        Its view and that view's covariance.
    rig : ndarray
        As in `vision.rig`.
    drift : float
        Standard deviation of the places that the view itself rests on, m.
    """
    h, w = picture.shape[:2]
    grey = _small(picture)
    factor = w / grey.shape[1]
    found = cv2.goodFeaturesToTrack(
        grey, MOST_CORNERS, LEAST_RESPONSE, APART, mask=_on_ice(view, rig, (w, h), grey),
        useHarrisDetector=True,
    )  # fmt: skip
    corners = np.zeros((0, 2)) if found is None else found.reshape(-1, 2).astype(np.float64)
    ice = camera(view, rig, (w, h)).ice(_large(corners, factor))
    spread = _spread(ice, view, rig, cov, (w, h))
    return Keyframe(frame, view, rig, grey, ice, corners, float(np.hypot(drift, spread)))


def _on_ice(view: View, rig: Array, size: tuple[int, int], grey: Image) -> Image:
    """Mask of a small picture: where there is ice, 255."""
    edge = np.linspace(0, 1, 20)[:, None]
    sides = zip(ICE, np.roll(ICE, -1, axis=0), strict=True)
    rim = np.concatenate([one + edge * (two - one) for one, two in sides])
    outline = project(rim, view.vector, rig, size)
    with np.errstate(invalid="ignore"):
        outline = outline[(np.abs(outline) < 10 * size[0]).all(1)]
    mask = np.zeros(grey.shape, np.uint8)
    if len(outline) > 2:
        hull = cv2.convexHull(_shrunk(outline, size[0] / grey.shape[1]).astype(np.float32))
        cv2.fillConvexPoly(mask, np.round(hull).astype(np.int32), 255)
    return mask


def recognise(key: Keyframe, picture: Picture, view: View, rig: Array) -> Marks | None:
    """Find the landmarks of a keyframe in a picture, as marks.

    Parameters
    ----------
    key : Keyframe
    picture : Picture
    view, rig : View, ndarray
        The picture's camera, as far as it is known: within a tenth of the picture.

    Returns
    -------
    Marks or None
        None where the picture does not show the same scene.
    """
    h, w = picture.shape[:2]
    grey = _small(picture)
    factor = w / grey.shape[1]
    size = np.array([grey.shape[1], grey.shape[0]])
    expected = _shrunk(project(key.ice, view.vector, rig, (w, h)), factor)
    with np.errstate(invalid="ignore"):
        near = np.flatnonzero(((expected > -0.2 * size) & (expected < 1.2 * size)).all(1))
    if len(near) < LEAST_CORNERS:
        return None
    corners, there = key.corners[near], expected[near]
    warped, one = key.grey, corners
    warp = _affine(corners, there)
    if np.abs(warp[:, :2] - np.eye(2)).max() > ALIKE:
        shown = (grey.shape[1], grey.shape[0])
        border = cv2.BORDER_REPLICATE
        warped = np.asarray(cv2.warpAffine(key.grey, warp, shown, borderMode=border), np.uint8)
        one = corners @ warp[:, :2].T + warp[:, 2]
    before = one.astype(np.float32)
    after, ok, _ = cv2.calcOpticalFlowPyrLK(
        warped, grey, before, there.astype(np.float32), winSize=WINDOW, maxLevel=LEVELS,
        criteria=TERMINATION, flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )  # fmt: skip
    # What is the same is found again from there: it was there that one looked, so near at hand.
    back, ok_back, _ = cv2.calcOpticalFlowPyrLK(
        grey, warped, after, before.copy(), winSize=WINDOW, maxLevel=0,
        criteria=TERMINATION, flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )  # fmt: skip
    two = after.astype(np.float64)
    good = np.flatnonzero(
        ((ok == 1) & (ok_back == 1)).ravel()
        & ((two > 3) & (two < size - 4)).all(1)
        & (np.abs(back - before).max(1) < 1.0)
    )
    if len(good) < LEAST_CORNERS:
        return None
    motion, together = cv2.estimateAffinePartial2D(one[good], two[good], ransacReprojThreshold=1.5)
    if motion is None:
        return None
    kept = good[together.ravel() == 1]
    due = one @ motion[:, :2].T + motion[:, 2]
    count = int(((due > 3) & (due < size - 4)).all(1).sum())
    cells = set((two[kept] / size * CELLS).astype(int) @ (1, CELLS[0]))
    if len(kept) < max(LEAST_CORNERS, LEAST_SHARE * count) or len(cells) < LEAST_CELLS:
        return None
    return fixed(key.ice[near[kept]], _large(two[kept], factor), CORNER_SD * factor)


def _affine(start: Array, end: Array) -> Array:
    """Affine motion from places to places, (n, 2) each, by least squares, shape (2, 3)."""
    design = np.column_stack([start, np.ones(len(start))])
    return np.asarray(np.linalg.lstsq(design, end, rcond=None)[0].T)


def replaced(marks: Marks, key: Keyframe, now: Camera) -> Marks:
    """Put the points of a keyframe where a better camera of its frame has them."""
    which = marks.line == FIXED
    if marks.across is None or not which.any():
        return marks
    ice = np.stack([marks.along, marks.across], axis=-1)
    ice[which] = now.ice(project(ice[which], key.view.vector, key.rig, now.size))
    return replace(marks, along=ice[:, 0], across=ice[:, 1])


def _small(picture: Picture) -> Image:
    """Halve the lightness of a picture until it is small: halving is quicker than any other."""
    if isinstance(picture, Planes):
        grey = picture.luma
    else:
        grey = np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)
    while grey.shape[1] > WIDEST:
        half = (grey.shape[1] // 2, grey.shape[0] // 2)
        grey = np.asarray(cv2.resize(grey, half, interpolation=cv2.INTER_AREA), np.uint8)
    return grey


def _large(small: Array, factor: float) -> Array:
    """Pixels of the small picture to those of the picture: X = (x + 1/2) f − 1/2."""
    return (small + 0.5) * factor - 0.5


def _shrunk(large: Array, factor: float) -> Array:
    return (large + 0.5) / factor - 0.5


def _spread(ice: Array, view: View, rig: Array, cov: Array, size: tuple[int, int]) -> float:
    """Tell how well, m, a view of covariance `cov` places these points of the ice, rms."""
    if not len(ice):
        return 0.0
    pixel = project(ice, view.vector, rig, size)
    total = 0.0
    values, axes = np.linalg.eigh(cov)
    for value, axis in zip(values, axes.T, strict=True):
        moved = View(view.vector + np.sqrt(max(value, 0.0)) * axis)
        off = camera(moved, rig, size).ice(pixel) - ice
        total += float((off**2).sum(1).mean()) / 2
    return float(np.sqrt(total))
