"""Keyframes: small grey pictures with corners whose places on the ice are known."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.paint import FIXED, Marks
from curlshot.vision.optics.pose import View, camera, project
from curlshot.vision.video.picture import Image, Picture, Planes

Array = NDArray[np.float64]

WIDEST = 800
"""Width of the small pictures at most, px: a picture is halved until it is as small."""

MOST_CORNERS = 100
APART = 10
"""Corners of a keyframe, and their least distance, px of the small picture."""

LEAST_RESPONSE = 1e-4
"""Least response of a corner, of the strongest one's (Harris and Stephens, 1988, A combined corner
and edge detector, Alvey Vision Conference): along the edges of lines points would slide."""

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
        As in `curlshot.vision.optics.rig`.
    drift : float
        Standard deviation of the places that the view itself rests on, m.
    """
    h, w = picture.shape[:2]
    grey = small_of(picture)
    factor = w / grey.shape[1]
    found = cv2.goodFeaturesToTrack(
        grey, MOST_CORNERS, LEAST_RESPONSE, APART, mask=_on_ice(view, rig, (w, h), grey),
        useHarrisDetector=True,
    )  # fmt: skip
    corners = np.zeros((0, 2)) if found is None else found.reshape(-1, 2).astype(np.float64)
    ice = camera(view, rig, (w, h)).ice(enlarged(corners, factor))
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
        hull = cv2.convexHull(shrunk(outline, size[0] / grey.shape[1]).astype(np.float32))
        cv2.fillConvexPoly(mask, np.round(hull).astype(np.int32), 255)
    return mask


def replaced(marks: Marks, key: Keyframe, now: Camera) -> Marks:
    """Put the points of a keyframe where a better camera of its frame has them."""
    which = marks.line == FIXED
    if marks.across is None or not which.any():
        return marks
    ice = np.stack([marks.along, marks.across], axis=-1)
    ice[which] = now.ice(project(ice[which], key.view.vector, key.rig, now.size))
    return replace(marks, along=ice[:, 0], across=ice[:, 1])


def small_of(picture: Picture, widest: int = WIDEST) -> Image:
    """Halve the lightness of a picture until it is no wider: halving is quicker than any other."""
    if isinstance(picture, Planes):
        grey = picture.luma
    else:
        grey = np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), np.uint8)
    while grey.shape[1] > widest:
        half = (grey.shape[1] // 2, grey.shape[0] // 2)
        grey = np.asarray(cv2.resize(grey, half, interpolation=cv2.INTER_AREA), np.uint8)
    return grey


def enlarged(small: Array, factor: float) -> Array:
    """Pixels of the small picture to those of the picture: X = (x + 1/2) f − 1/2."""
    return (small + 0.5) * factor - 0.5


def shrunk(large: Array, factor: float) -> Array:
    """Pixels of the picture to those of the small picture."""
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
