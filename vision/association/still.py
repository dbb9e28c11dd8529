"""Stones at rest, told by their pictures: what looks as it did is where it was.

A stone that rests is measured in full now and then. In between its picture is compared with
the one that was taken then, at the same place of the ice: how far it has shifted, to hundredths
of a pixel (Lucas and Kanade, 1981, Proc. IJCAI 674), follows from its gradients, whatever the
light. Where anything else has changed, nothing is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.detection import Detection
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.video.picture import Picture, lightness_at

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

ACROSS = 19
"""Samples across a stone."""

NOISE = 2.0
"""Standard deviation of the lightness of a sample that stays the same, grey levels."""

MOST_SD = 0.1
"""Standard error of a shift beyond which a picture shows too little to tell it, px."""

MOST_SHIFT = 0.6
"""Largest shift that is told from gradients, px."""

CHANGED, CONTRAST = 3.0, 0.05
"""Rest of the lightness that says that something has changed: in grey levels, and what a share
of the picture's own contrast adds."""

LEAST_LEFT = 0.5
"""Share of its contrast that a stone keeps in any light: what covers it evenly has none."""


@dataclass(frozen=True)
class Portrait:
    """A stone's picture when it was measured.

    Attributes
    ----------
    detection : Detection
        As measured.
    t : float
        When, s.
    lightness : ndarray, shape (m,)
        Of the samples.
    design : ndarray, shape (m, 4)
        Change of the lightness by a shift (px, two axes), by contrast and by brightness.
    inverse : ndarray, shape (4, m)
        Least-squares solution by it.
    """

    detection: Detection
    t: float
    lightness: Array
    design: Array
    inverse: Array

    @property
    def most(self) -> float:
        """Root mean square of what may be left where nothing has changed, grey levels."""
        return CHANGED + CONTRAST * float(self.lightness.std())


@lru_cache(maxsize=4)
def _samples(disc: Stone) -> Array:
    """Places on a disc about its centre, m, shape (m, 2)."""
    offset = np.linspace(-1.0, 1.0, ACROSS)
    x, y = np.meshgrid(offset, offset)
    inside = np.hypot(x, y) < 0.96
    return np.asarray(disc.radius * np.stack([x[inside], y[inside]], -1))


def _pixels(by: Cameras, places: Array, disc: Stone) -> tuple[Array, Array, Array]:
    """Pixels of the samples about places, (n, m, 2), of their middles, and px per metre, (n, 2, 2).

    Over a stone the camera is taken for linear: the same in both pictures.
    """
    reach = 0.5 * disc.radius
    about = np.array([[0.0, 0.0], [reach, 0.0], [0.0, reach]])
    seen = by.project(places[:, None] + about, disc.cap_height)
    scale = np.swapaxes(seen[:, 1:] - seen[:, :1], 1, 2) / reach
    return seen[:, :1] + _samples(disc) @ np.swapaxes(scale, 1, 2), seen[:, 0], scale


def _lightness(picture: Picture, pixels: Array) -> Array:
    at = pixels.astype(np.float32)
    return lightness_at(picture, at[..., 0], at[..., 1]).astype(float)


def portraits(
    picture: Picture, camera: Camera, t: float, seen: Sequence[Detection], disc: Stone
) -> list[Portrait | None]:
    """Take the pictures of stones that were measured in a picture.

    Parameters
    ----------
    picture, camera, t : Picture, Camera, float
        The picture, its camera and its time, s.
    seen : sequence of Detection
        The stones.
    disc : Stone
        Their size.

    Returns
    -------
    list of Portrait or None
        None where a stone is not wholly in view, or shows too little to tell a shift.
    """
    if not seen:
        return []
    by = Cameras.of([camera], [len(seen)])
    pixels, _, _ = _pixels(by, np.array([(s.x, s.y) for s in seen]), disc)
    limit = np.array(camera.size) - 2.0
    whole = np.all((pixels > 1) & (pixels < limit), axis=(1, 2)).tolist()
    step = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    shape = (len(seen) * len(step), -1, 2)
    around = _lightness(picture, (pixels[:, None] + step[:, None]).reshape(shape))
    middle, right, left, below, above = np.moveaxis(around.reshape(len(seen), len(step), -1), 1, 0)
    design = np.stack([(left - right) / 2, (above - below) / 2, middle, np.ones_like(middle)], -1)
    normal = np.swapaxes(design, 1, 2) @ design + 1e-6 * np.eye(4)
    spread = np.linalg.inv(normal)
    told = np.sqrt(np.maximum(spread[:, 0, 0], spread[:, 1, 1])) * NOISE < MOST_SD
    inverse = spread @ np.swapaxes(design, 1, 2)
    return [
        Portrait(s, t, middle[i], design[i], inverse[i]) if whole[i] and told[i] else None
        for i, s in enumerate(seen)
    ]


def unchanged(
    views: Sequence[tuple[Picture, Camera]], known: Sequence[Portrait], disc: Stone
) -> list[list[Detection | None]]:
    """Look whether stones look in pictures as they did in their portraits.

    Returns
    -------
    list of list of Detection or None
        For each picture and portrait the detection with the place by this picture, without a
        picture of the handle; None where something has changed, or is in the way.
    """
    if not known:
        return [[] for _ in views]
    places = np.array([(p.detection.x, p.detection.y) for p in known])
    by = Cameras.of([camera for _, camera in views], [len(known)] * len(views))
    pixels, middle, scale = (
        each.reshape(len(views), len(known), *each.shape[1:])
        for each in _pixels(by, np.tile(places, (len(views), 1)), disc)
    )
    lightness = [_lightness(picture, at) for (picture, _), at in zip(views, pixels, strict=True)]
    change = np.array(lightness) - np.array([p.lightness for p in known])
    found = (np.array([p.inverse for p in known]) @ change[..., None])[..., 0]
    rest = change - (np.array([p.design for p in known]) @ found[..., None])[..., 0]
    kept = 1 + found[..., 2]
    # Gradients have changed with the contrast.
    shift = found[..., :2] / np.maximum(kept, LEAST_LEFT)[..., None]
    left = np.sqrt((rest**2).mean(-1))
    still = (left < np.array([p.most for p in known])) & (np.abs(shift).max(-1) < MOST_SHIFT)
    still &= kept > LEAST_LEFT
    moved = places + np.linalg.solve(scale, shift[..., None])[..., 0]
    columns = (still.tolist(), moved.tolist(), (middle + shift).tolist())
    return [
        [
            p.detection._replace(x=x, y=y, pixel=(u, v), spectrum=None, measured=False)
            if ok
            else None
            for p, ok, (x, y), (u, v) in zip(known, *row, strict=True)
        ]
        for row in zip(*columns, strict=True)
    ]
