"""The camera of one frame: ice metres to pixels and back, with lens distortion and height."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

CAMERA_COLUMNS: tuple[str, ...] = (
    "frame", "t", *(f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
    "k1", "k2", "f_px", "cam_x", "cam_y", "cam_z", "rms_px", "found",
)  # fmt: skip


GRID_X = np.linspace(-2.4, 2.4, 7)
GRID_Y = np.linspace(-4.0, 8.0, 13)
"""Where the error is worked out, m; between is interpolated, beyond is as at the border."""


@dataclass(frozen=True)
class PlaceError:
    """Standard deviation per axis of a mapped ice point, m, shape (len(GRID_Y), len(GRID_X))."""

    grid: Array

    def at(self, ice: ArrayLike) -> Array:
        """Give the standard deviation per axis at ice points, shape (..., 2), m."""
        p = np.asarray(ice, float)
        i, u = _cell(GRID_Y, p[..., 1])
        j, v = _cell(GRID_X, p[..., 0])
        low = (1 - v) * self.grid[i, j] + v * self.grid[i, j + 1]
        high = (1 - v) * self.grid[i + 1, j] + v * self.grid[i + 1, j + 1]
        return np.asarray((1 - u) * low + u * high)

    def grown(self, sd: float) -> PlaceError:
        """Add an independent error of standard deviation `sd` (m) everywhere."""
        return replace(self, grid=np.hypot(self.grid, sd))


def _cell(grid: Array, value: Array) -> tuple[NDArray[np.int64], Array]:
    """Index of the cell that holds each value and how far into it the value lies, 0..1."""
    at = np.clip((value - grid[0]) / (grid[1] - grid[0]), 0, len(grid) - 1)
    index = np.minimum(at.astype(np.int64), len(grid) - 2)
    return index, at - index


@dataclass(frozen=True)
class Camera:
    """One frame's camera.

    Attributes
    ----------
    frame, t : int, float
        Index in the clip and time of mid-exposure, s.
    homography : ndarray, shape (3, 3)
        Ice metres (x, y, 1) to undistorted pixels, h33 = 1.
    size : tuple of int
        Width and height of the picture, px.
    k1, k2 : float
        Radial distortion: with c = ((w − 1)/2, (h − 1)/2), R = √(w² + h²)/2 and
        q = (u − c) / R, the pixel is c + R q (1 + k1 |q|² + k2 |q|⁴).
    f_px : float
        Focal length, px; NaN where unknown.
    position : ndarray, shape (3,)
        Place of the camera in ice coordinates, m; NaN where unknown.
    rms_px : float
        Residual of the edges that fixed it, px; NaN where there were none.
    found : bool
        True where the frame itself fixed it, False where it was carried.
    place_error : PlaceError, optional
        How well it knows the places of ice points; what neighbouring frames share.
    """

    frame: int
    t: float
    homography: Array
    size: tuple[int, int]
    k1: float = 0.0
    k2: float = 0.0
    f_px: float = float("nan")
    position: Array | None = None
    rms_px: float = float("nan")
    found: bool = True
    place_error: PlaceError | None = None

    @property
    def _centre_and_radius(self) -> tuple[Array, float]:
        w, h = self.size
        return np.array([(w - 1) / 2, (h - 1) / 2]), float(np.hypot(w, h)) / 2

    def distort(self, undistorted: ArrayLike) -> Array:
        """Undistorted pixels to pixels of the picture, shape (..., 2)."""
        u = np.asarray(undistorted, float)
        if self.k1 == 0 and self.k2 == 0:
            return u.copy()
        c, radius = self._centre_and_radius
        q = (u - c) / radius
        r2 = (q**2).sum(-1, keepdims=True)
        return np.asarray(c + radius * q * (1 + self.k1 * r2 + self.k2 * r2**2))

    def undistort(self, pixels: ArrayLike) -> Array:
        """Pixels of the picture to undistorted pixels, shape (..., 2); by Newton's method."""
        p = np.asarray(pixels, float)
        if self.k1 == 0 and self.k2 == 0:
            return p.copy()
        c, radius = self._centre_and_radius
        d = (p - c) / radius
        rd = np.sqrt((d**2).sum(-1, keepdims=True))
        r = rd.copy()
        for _ in range(8):
            f = r * (1 + self.k1 * r**2 + self.k2 * r**4) - rd
            slope = 1 + 3 * self.k1 * r**2 + 5 * self.k2 * r**4
            r = r - f / np.where(np.abs(slope) < 0.1, 0.1, slope)
        scale = np.divide(r, rd, out=np.ones_like(r), where=rd > 1e-12)
        return np.asarray(c + radius * d * scale)

    def project(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Points (x, y) in metres, `height` above the ice, to pixels, shape (..., 2).

        A point at a height lies on the ray through the ice point that hides behind it:
        with the camera at (X, Y, Z), (x, y, z) covers (x, y) + (x − X, y − Y) z / (Z − z).
        Without a known position the height is ignored.
        """
        xy = np.asarray(ice, float)
        if height and self.position is not None and np.isfinite(self.position).all():
            away = height / (self.position[2] - height)
            xy = xy + (xy - self.position[:2]) * away
        return self.distort(apply_homography(self.homography, xy))

    def ice(self, pixels: ArrayLike, height: float = 0.0) -> Array:
        """Pixels to the place (x, y), m, of what is seen there `height` above the ice."""
        xy = apply_homography(
            np.asarray(np.linalg.inv(self.homography), np.float64), self.undistort(pixels)
        )
        if height and self.position is not None and np.isfinite(self.position).all():
            xy = xy + (self.position[:2] - xy) * (height / self.position[2])
        return xy

    def place_sd(self, ice: ArrayLike) -> Array:
        """Give the standard deviation per axis, m, of mapped ice points; 0 where unknown."""
        p = np.asarray(ice, float)
        return np.zeros(p.shape[:-1]) if self.place_error is None else self.place_error.at(p)

    def scale_at(self, ice: ArrayLike) -> float:
        """Pixels per metre at an ice point: root of the determinant of the Jacobian."""
        x, y = np.asarray(ice, float)
        step = 1e-3
        p = self.project(np.array([[x + step, y], [x - step, y], [x, y + step], [x, y - step]]))
        jacobian = np.stack([p[0] - p[1], p[2] - p[3]], axis=1) / (2 * step)
        return float(np.sqrt(abs(np.linalg.det(jacobian))))


def apply_homography(matrix: Array, points: ArrayLike) -> Array:
    """Map points, shape (..., 2), by a 3×3 homography."""
    p = np.asarray(points, float)
    q = p @ matrix[:, :2].T + matrix[:, 2]
    return np.asarray(q[..., :2] / q[..., 2:])


def camera_table(cameras: Sequence[Camera]) -> pd.DataFrame:
    """Table of ``camera.csv``, one row per frame, with `CAMERA_COLUMNS`."""
    rows = []
    for cam in cameras:
        position = np.full(3, np.nan) if cam.position is None else cam.position
        rows.append(
            [cam.frame, cam.t, *cam.homography.ravel(), cam.k1, cam.k2, cam.f_px, *position,
             cam.rms_px, int(cam.found)]
        )  # fmt: skip
    return pd.DataFrame(rows, columns=list(CAMERA_COLUMNS))
