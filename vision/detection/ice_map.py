"""The ice seen from straight above: one picture rectified with its camera."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.picture import Image, Picture, colours_at, reduced

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

_CELL = 8
"""Pixels of the map from one node at which the camera is evaluated to the next."""


@dataclass(frozen=True)
class IceMap:
    """The ice as seen from straight above, at the height of the caps.

    Attributes
    ----------
    image : ndarray, shape (h, w, 3)
        BGR.
    valid : ndarray of bool, shape (h, w)
        Where the picture shows the ice.
    left, top : float
        Ice place of the middle of the pixel (0, 0), m.
    scale : float
        Pixels per metre.
    """

    image: Image
    valid: NDArray[np.bool_]
    left: float
    top: float
    scale: float

    def place(self, column: Array, row: Array) -> Array:
        """Ice place (x, y) of map pixels, shape (..., 2)."""
        return np.stack([self.left + column / self.scale, self.top - row / self.scale], -1)


def rectify(
    image: Picture,
    camera: Camera,
    bounds: tuple[float, float, float, float],
    *,
    scale: float,
    height: float = 0.0,
) -> IceMap | None:
    """Map the part of the picture that shows the sheet onto the ice.

    Parameters
    ----------
    image, camera : Picture, Camera
        The picture, and its camera.
    bounds : (x0, x1, y0, y1)
        The part of the ice to map, m; what the picture does not show is left out.
    scale : float
        Pixels of the map per metre.
    height : float
        Height above the ice of the plane that is mapped, m.

    Returns
    -------
    IceMap or None
        None where the picture shows nothing of that part.
    """
    x0, x1, y0, y1 = bounds
    width, high = camera.size
    cell = _CELL
    xs = np.arange(x0, x1 + cell / scale, cell / scale)
    ys = np.arange(y1, y0 - cell / scale, -cell / scale)
    ice = np.stack(np.meshgrid(xs, ys), -1)
    ground = camera.behind(ice, height)
    depth = ground @ camera.homography[2, :2] + camera.homography[2, 2]
    nodes = np.full(ground.shape, -1e4)
    nodes[depth > 0.05] = camera.project(ground[depth > 0.05])
    inside = np.all((nodes > -0.5) & (nodes < np.array([width, high]) - 0.5), axis=-1)
    rows, columns = np.flatnonzero(np.any(inside, 1)), np.flatnonzero(np.any(inside, 0))
    if len(rows) < 2 or len(columns) < 2:
        return None
    top, bottom = max(rows[0] - 1, 0), min(rows[-1] + 2, len(ys))
    left, right = max(columns[0] - 1, 0), min(columns[-1] + 2, len(xs))
    part = np.asarray(nodes[top:bottom, left:right], np.float32)
    shape = ((bottom - top - 1) * cell, (right - left - 1) * cell)
    finer = np.array([[1 / cell, 0, 0], [0, 1 / cell, 0]])
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    across, down = (
        np.asarray(cv2.warpAffine(axis, finer, shape[::-1], flags=flags), np.float32)
        for axis in cv2.split(part)
    )
    # A picture much finer than the map is averaged first, else the map would be grainy.
    fine = np.sqrt(inside.sum()) * cell
    finest = max(1.0, 0.8 * float(np.sqrt(_visible_area(part, width, high))) / fine)
    coarser = 2 ** int(np.log2(finest))  # halving is fast
    if coarser > 1:
        image = reduced(image, coarser)
        across, down = ((axis + 0.5) / coarser - 0.5 for axis in (across, down))
    ice_image = colours_at(image, across, down)
    valid = (across >= 0) & (across <= image.shape[1] - 1)
    valid &= (down >= 0) & (down <= image.shape[0] - 1)
    return IceMap(ice_image, valid, float(xs[left]), float(ys[top]), float(scale))


def _visible_area(nodes: Floats, width: int, height: int) -> float:
    """Pixels of the picture that the nodes' hull covers, at most all of them."""
    low = np.clip(nodes.min((0, 1)), 0, [width, height])
    high = np.clip(nodes.max((0, 1)), 0, [width, height])
    return float(np.prod(np.maximum(high - low, 1)))
