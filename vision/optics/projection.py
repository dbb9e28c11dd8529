"""Projection of points as plain functions: homography, lens distortion, height, Jacobians.

All take one camera, or one for each point: what is said of a camera has as many axes as what is
said of its points, but for the last one (two of them), or broadcasts to it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Size = tuple[int, int]

PARAMETERS = 9
"""Turn about the camera's own axes (3, rad), log focal length, place (3, m), k1, k2."""

STEP = 1e-3
AROUND = STEP * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
"""Where points around one are seen to tell how long a pixel is there, m."""


def distort(undistorted: Array, k1: Array | float, k2: Array | float, size: Size) -> Array:
    """As `Camera.distort`."""
    # Axis by axis: several times as fast as along a last axis of two.
    (c_x, c_y), radius = middle(size)
    x, y = undistorted[..., 0] - c_x, undistorted[..., 1] - c_y
    r2 = (x * x + y * y) / radius**2
    stretch = 1 + r2 * (k1 + k2 * r2)
    seen = np.empty(undistorted.shape)
    seen[..., 0], seen[..., 1] = c_x + x * stretch, c_y + y * stretch
    return seen


def undistort(pixels: Array, k1: Array | float, k2: Array | float, size: Size) -> Array:
    """As `Camera.undistort`."""
    c, radius = middle(size)
    d = (pixels - c) / radius
    rd = np.sqrt((d * d).sum(-1))
    r = rd.copy()
    for _ in range(6):
        r2 = r * r
        far = k2 * r2
        slope = 1 + r2 * (3 * k1 + 5 * far)
        r -= (r * (1 + r2 * (k1 + far)) - rd) / np.where(np.abs(slope) < 0.1, 0.1, slope)
    scale = np.divide(r, rd, out=np.ones_like(r), where=rd > 1e-12)
    return np.asarray(c + radius * d * scale[..., None])


def behind(ice: Array, height: Array | float, position: Array) -> Array:
    """As `Camera.behind`."""
    rise = np.asarray(height, float)[..., None]
    return np.asarray(ice + (ice - position[..., :2]) * rise / (position[..., 2:] - rise))


def rotation(homography: Array, f_px: Array | float, size: Size) -> Array:
    """As `Camera.rotation`, shape (..., 3, 3)."""
    c, _ = middle(size)
    found = np.empty(homography.shape)
    found[..., :2] = homography[..., :2]
    found[..., :2, :2] -= c[:, None] * found[..., 2:, :2]
    found[..., :2, :2] /= np.asarray(f_px)[..., None, None]
    found[..., :2] /= np.sqrt((found[..., 0] ** 2).sum(-1))[..., None, None]
    a, b = found[..., 0], found[..., 1]
    # The cross product; np.cross takes several times as long.
    found[..., 2] = a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]
    return found


def place_jacobian(
    away: Array, rotation: Array, focal: Array | float, k1: Array | float, k2: Array | float
) -> Array:
    """As `Camera.place_jacobian`, of points so far from the camera, m.

    `focal` is the focal length in half diagonals of the picture.
    """
    p = (rotation @ away[..., None])[..., 0]
    lens = focal / p[..., 2]
    q = p[..., :2] * lens[..., None]
    by_point = np.zeros((*away.shape[:-1], 2, 3))
    by_point[..., 0, 0] = by_point[..., 1, 1] = lens
    by_point[..., 2] = -q / p[..., 2:]
    moved = np.empty((*away.shape[:-1], 2, PARAMETERS))
    moved[..., :3] = by_point @ _crossing(-p)
    moved[..., 3] = q
    moved[..., 4:7] = -by_point @ rotation
    r2 = (q**2).sum(-1)
    slope = 1 + r2 * (3 * k1 + 5 * k2 * r2)
    moved[..., 7] = q * (r2 / slope)[..., None]
    moved[..., 8] = q * (r2**2 / slope)[..., None]
    return np.asarray(-np.linalg.solve(by_point @ rotation[..., :2], moved))


def shared_place_cov(
    ice: Array, by_camera: Array, shared: Array, scale: Array | float, drift: Array | float
) -> Array:
    """As `Camera.shared_place_cov`; `by_camera` is what `place_jacobian` says."""
    found = by_camera @ shared @ np.swapaxes(by_camera, -1, -2)
    scaled = np.asarray(scale)[..., None] * ice
    found += scaled[..., :, None] * scaled[..., None, :]
    return np.asarray(found + np.square(drift)[..., None, None] * np.eye(2))


def scale_of(around: Array) -> Array:
    """Pixels per metre where points are seen so `AROUND` another one, shape (..., 4, 2)."""
    along = (around[..., 0, :] - around[..., 1, :]) / (2 * STEP)
    up = (around[..., 2, :] - around[..., 3, :]) / (2 * STEP)
    area = along[..., 0] * up[..., 1] - along[..., 1] * up[..., 0]
    return np.asarray(np.sqrt(np.abs(area)))


@lru_cache(maxsize=8)
def middle(size: Size) -> tuple[Array, float]:
    """Middle and half diagonal of a picture, px."""
    w, h = size
    centre = np.array([(w - 1) / 2, (h - 1) / 2])
    centre.flags.writeable = False
    return centre, float(np.hypot(w, h)) / 2


def _crossing(vectors: Array) -> Array:
    """Matrices, shape (..., 3, 3), by which rows are multiplied to be crossed with vectors."""
    out = np.zeros((*vectors.shape, 3))
    x, y, z = np.moveaxis(vectors, -1, 0)
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -z, y, -x
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = z, -y, x
    return out


def apply_homography(matrix: Array, points: ArrayLike) -> Array:
    """Map points, shape (..., 2), by a 3×3 homography."""
    p = np.asarray(points, float)
    q = p @ matrix[:, :2].T + matrix[:, 2]
    return np.asarray(q[..., :2] / q[..., 2:])
