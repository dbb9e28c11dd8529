"""The camera of one frame: ice metres to pixels and back, with lens distortion and height."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from data.tracks import Columns

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

CAMERA_COLUMNS: tuple[str, ...] = (
    "frame", "t", *(f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
    "k1", "k2", "f_px", "cam_x", "cam_y", "cam_z", "rms_px", "found",
)  # fmt: skip


PARAMETERS = 9
"""Turn about the camera's own axes (3, rad), log focal length, place (3, m), k1, k2."""


@dataclass(frozen=True)
class CameraError:
    """How well a camera is known.

    Attributes
    ----------
    shared, own : ndarray, shape (9, 9)
        Covariance of the camera's parameters (see `PARAMETERS`): the part that a clip's frames
        share and the part that each has for itself.
    scale : float
        Standard deviation of the logarithm of all lengths: how well the yardstick is known.
    drift : float
        Standard deviation per axis of what a carried view has gone astray, m on the ice.
    """

    shared: Array
    own: Array
    scale: float = 0.0
    drift: float = 0.0


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
    position : ndarray, shape (3,), optional
        Place of the camera in ice coordinates, m; None where unknown.
    rms_px : float
        Residual of the edges that fixed it, px; NaN where there were none.
    found : bool
        True where the frame itself fixed it, False where it was carried.
    error : CameraError, optional
        How well it is known.
    quality : float
        From 0 to 1: the share of the circles in the picture that is explained, less where the
        residual is large; 0 where carried, NaN where unknown.
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
    error: CameraError | None = None
    quality: float = float("nan")

    @property
    def _centre_and_radius(self) -> tuple[Array, float]:
        return _middle(self.size)

    def distort(self, undistorted: ArrayLike) -> Array:
        """Undistorted pixels to pixels of the picture, shape (..., 2)."""
        u = np.asarray(undistorted, float)
        if self.k1 == 0 and self.k2 == 0:
            return u.copy()
        c, radius = self._centre_and_radius
        away = u - c
        x, y = away[..., 0], away[..., 1]
        r2 = (x * x + y * y) / radius**2  # several times as fast as a sum over the last axis
        away *= (1 + r2 * (self.k1 + self.k2 * r2))[..., None]
        return np.asarray(c + away)

    def undistort(self, pixels: ArrayLike) -> Array:
        """Pixels of the picture to undistorted pixels, shape (..., 2); by Newton's method."""
        p = np.asarray(pixels, float)
        if self.k1 == 0 and self.k2 == 0:
            return p.copy()
        c, radius = self._centre_and_radius
        d = (p - c) / radius
        rd = np.sqrt((d * d).sum(-1, keepdims=True))
        r = rd.copy()
        for _ in range(6):
            r2 = r * r
            far = self.k2 * r2
            slope = 1 + r2 * (3 * self.k1 + 5 * far)
            r -= (r * (1 + r2 * (self.k1 + far)) - rd) / np.where(np.abs(slope) < 0.1, 0.1, slope)
        scale = np.divide(r, rd, out=np.ones_like(r), where=rd > 1e-12)
        return np.asarray(c + radius * d * scale)

    def project(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Points (x, y) in metres, `height` above the ice, to pixels, shape (..., 2).

        A point at a height lies on the ray through the ice point that hides behind it:
        with the camera at (X, Y, Z), (x, y, z) covers (x, y) + (x − X, y − Y) z / (Z − z).
        Without a known position the height is ignored.
        """
        xy = np.asarray(ice, float)
        behind = self.behind(xy, height) if height else xy
        return self.distort(apply_homography(self.homography, behind))

    def behind(self, ice: Array, height: Array | float) -> Array:
        """Ice points hidden behind points (x, y), shape (..., 2), that are `height` above the ice.

        See `project`.
        """
        if self.position is None:
            return ice
        rise = np.asarray(height, float)[..., None]
        return np.asarray(ice + (ice - self.position[:2]) * rise / (self.position[2] - rise))

    def ice(self, pixels: ArrayLike, height: float = 0.0) -> Array:
        """Pixels to the place (x, y), m, of what is seen there `height` above the ice."""
        xy = apply_homography(
            np.asarray(np.linalg.inv(self.homography), np.float64), self.undistort(pixels)
        )
        if height and self.position is not None:
            xy = xy + (self.position[:2] - xy) * (height / self.position[2])
        return xy

    @property
    def rotation(self) -> Array:
        """Ice axes to camera axes (x right, y down, z forward), shape (3, 3).

        The homography is K [r1 r2 −R C] up to a factor.
        """
        c, _ = self._centre_and_radius
        found = np.empty((3, 3))
        found[:, :2] = self.homography[:, :2]
        found[:2, :2] -= c[:, None] * found[2, :2]
        found[:2, :2] /= self.f_px
        found[:, :2] /= np.linalg.norm(found[:, 0])
        a, b = found[:, 0], found[:, 1]
        # The cross product; np.cross takes several times as long.
        found[:, 2] = a[[1, 2, 0]] * b[[2, 0, 1]] - a[[2, 0, 1]] * b[[1, 2, 0]]
        return found

    def place_cov(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Covariance of mapped points, shape (..., 2, 2), m²; zero where nothing is known of it.

        Parameters
        ----------
        ice : array_like, shape (..., 2)
            Places (x, y), m.
        height : float
            Height of the points above the ice, m.
        """
        if self.error is None:
            return np.zeros((*np.shape(ice), 2))
        return self.own_place_cov(ice, height) + self.shared_place_cov(ice, height)

    def own_place_cov(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Part of `place_cov` that each frame has for itself, shape (..., 2, 2), m²."""
        if self.error is None:
            return np.zeros((*np.shape(ice), 2))
        by_camera = self.place_jacobian(ice, height)
        return np.asarray(by_camera @ self.error.own @ np.swapaxes(by_camera, -1, -2))

    def shared_place_cov(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Part of `place_cov` that neighbouring frames share, shape (..., 2, 2), m²."""
        xy = np.asarray(ice, float)
        if self.error is None:
            return np.zeros((*xy.shape, 2))
        by_camera = self.place_jacobian(xy, height)
        found = by_camera @ self.error.shared @ np.swapaxes(by_camera, -1, -2)
        found += self.error.scale**2 * xy[..., :, None] * xy[..., None, :]
        return np.asarray(found + self.error.drift**2 * np.eye(2))

    def place_sd(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Give the standard deviation per axis, m, of mapped points: the part frames share.

        Root mean square of the two axes; 0 where nothing is known of it.
        """
        cov = self.shared_place_cov(ice, height)
        return np.asarray(np.sqrt(np.trace(cov, axis1=-2, axis2=-1) / 2))

    def place_jacobian(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Change of what a pixel is mapped to by the camera's parameters, shape (..., 2, 9).

        The pixel stays: what the parameters move in the picture, the place must move back.

        Raises
        ------
        ValueError
            The camera's place is not known.
        """
        if self.position is None:
            raise ValueError("the camera's place is not known")
        xy = np.asarray(ice, float)
        rotation = self.rotation
        away = np.concatenate([xy, np.full((*xy.shape[:-1], 1), height)], axis=-1) - self.position
        p = away @ rotation.T
        _, radius = self._centre_and_radius
        lens = self.f_px / radius / p[..., 2]
        q = p[..., :2] * lens[..., None]
        by_point = np.zeros((*xy.shape[:-1], 2, 3))
        by_point[..., 0, 0] = by_point[..., 1, 1] = lens
        by_point[..., 2] = -q / p[..., 2:]
        moved = np.empty((*xy.shape[:-1], 2, PARAMETERS))
        moved[..., :3] = by_point @ _crossing(-p)
        moved[..., 3] = q
        moved[..., 4:7] = -by_point @ rotation
        r2 = (q**2).sum(-1, keepdims=True)
        slope = 1 + r2 * (3 * self.k1 + 5 * self.k2 * r2)
        moved[..., 7] = q * r2 / slope
        moved[..., 8] = q * r2**2 / slope
        return np.asarray(-np.linalg.solve(by_point @ rotation[:, :2], moved))

    def scale_at(self, ice: ArrayLike) -> Array:
        """Pixels per metre at ice points, shape (..., 2): root of the Jacobian's determinant."""
        step = 1e-3 * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        p = self.project(np.asarray(ice, float)[..., None, :] + step)
        along, up = (p[..., 0, :] - p[..., 1, :]) / 2e-3, (p[..., 2, :] - p[..., 3, :]) / 2e-3
        area = along[..., 0] * up[..., 1] - along[..., 1] * up[..., 0]
        return np.asarray(np.sqrt(np.abs(area)))


@lru_cache(maxsize=8)
def _middle(size: tuple[int, int]) -> tuple[Array, float]:
    """Middle and half diagonal of a picture, px."""
    w, h = size
    middle = np.array([(w - 1) / 2, (h - 1) / 2])
    middle.flags.writeable = False
    return middle, float(np.hypot(w, h)) / 2


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


def camera_columns(cameras: Sequence[Camera]) -> Columns:
    """Table of ``camera.csv``, one row per frame, with `CAMERA_COLUMNS`."""
    rows = np.empty((len(cameras), len(CAMERA_COLUMNS)))
    for row, cam in zip(rows, cameras, strict=True):
        position = np.full(3, np.nan) if cam.position is None else cam.position
        row[:] = (
            cam.frame, cam.t, *cam.homography.ravel(), cam.k1, cam.k2, cam.f_px, *position,
            cam.rms_px, cam.found,
        )  # fmt: skip
    table: Columns = dict(zip(CAMERA_COLUMNS, rows.T, strict=True))
    return table | {name: table[name].astype(int) for name in ("frame", "found")}


def camera_table(cameras: Sequence[Camera]) -> pd.DataFrame:
    """As `camera_columns`, as a DataFrame."""
    import pandas as pd

    return pd.DataFrame(camera_columns(cameras))
