"""The camera of one frame: ice metres to pixels and back, with lens distortion and height."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.tracks import Columns
from curlshot.vision.optics import projection

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

CAMERA_COLUMNS: tuple[str, ...] = (
    "frame", "t", *(f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
    "k1", "k2", "f_px", "cam_x", "cam_y", "cam_z", "rms_px", "found",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class CameraError:
    """How well a camera is known.

    Attributes
    ----------
    shared, own : ndarray, shape (9, 9)
        Covariance of the camera's parameters (`curlshot.vision.optics.projection.PARAMETERS`): the
        part that a clip's frames share and the part that each has for itself.
    scale : float
        Standard deviation of the logarithm of all lengths: how well the yardstick is known.
    drift : float
        Standard deviation per axis of what a carried view has gone astray, m on the ice.
    """

    shared: Array
    own: Array
    scale: float = 0.0
    drift: float = 0.0


@dataclass(frozen=True, slots=True)
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
        From 0 to 1: the share of the circles in the picture that is explained, less where their
        edges are far off; 0 where carried, NaN where unknown.
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

    def distort(self, undistorted: ArrayLike) -> Array:
        """Undistorted pixels to pixels of the picture, shape (..., 2)."""
        u = np.asarray(undistorted, float)
        if self.k1 == 0 and self.k2 == 0:
            return u.copy()
        return projection.distort(u, self.k1, self.k2, self.size)

    def undistort(self, pixels: ArrayLike) -> Array:
        """Pixels of the picture to undistorted pixels, shape (..., 2); by Newton's method."""
        p = np.asarray(pixels, float)
        if self.k1 == 0 and self.k2 == 0:
            return p.copy()
        return projection.undistort(p, self.k1, self.k2, self.size)

    def project(self, ice: ArrayLike, height: float = 0.0) -> Array:
        """Points (x, y) in metres, `height` above the ice, to pixels, shape (..., 2).

        A point at a height lies on the ray through the ice point that hides behind it:
        with the camera at (X, Y, Z), (x, y, z) covers (x, y) + (x − X, y − Y) z / (Z − z).
        Without a known position the height is ignored.
        """
        xy = np.asarray(ice, float)
        on_ice = self.behind(xy, height) if height else xy
        return self.distort(projection.apply_homography(self.homography, on_ice))

    def behind(self, ice: Array, height: Array | float) -> Array:
        """Ice points hidden behind points (x, y), shape (..., 2), that are `height` above the ice.

        See `project`.
        """
        if self.position is None:
            return ice
        return projection.behind(ice, height, self.position)

    def ice(self, pixels: ArrayLike, height: float = 0.0) -> Array:
        """Pixels to the place (x, y), m, of what is seen there `height` above the ice."""
        xy = projection.apply_homography(
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
        return projection.rotation(self.homography, self.f_px, self.size)

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
        error = self.error
        return projection.shared_place_cov(xy, by_camera, error.shared, error.scale, error.drift)

    def place_sd(self, ice: ArrayLike) -> Array:
        """Give the standard deviation per axis, m, of mapped points: the part frames share.

        Root mean square of the two axes; 0 where nothing is known of it.
        """
        cov = self.shared_place_cov(ice)
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
            raise ValueError("the position of the camera is unknown")
        xy = np.asarray(ice, float)
        away = np.concatenate([xy, np.full((*xy.shape[:-1], 1), height)], axis=-1) - self.position
        _, radius = projection.middle(self.size)
        return projection.place_jacobian(away, self.rotation, self.f_px / radius, self.k1, self.k2)

    def scale_at(self, ice: ArrayLike) -> Array:
        """Pixels per metre at ice points, shape (..., 2): root of the Jacobian's determinant."""
        return projection.scale_of(
            self.project(np.asarray(ice, float)[..., None, :] + projection.AROUND)
        )

    def retimed(self, t: float) -> Camera:
        """Return the camera at another time, s."""
        return replace(self, t=t)

    def repeated(self, duplicate: int, t: float) -> Camera:
        """Return the camera of a frame that shows this one again: carried, not found in it."""
        return replace(self, frame=duplicate, t=t, found=False)

    def padded(self, bars: tuple[int, int], size: tuple[int, int]) -> Camera:
        """Return the camera in pixels of a larger picture, which has bars around this one.

        Parameters
        ----------
        bars : (int, int)
            Widths at either side, and at top and bottom, px.
        size : (int, int)
            Of the larger picture, px.
        """
        moved = np.eye(3)
        moved[:2, 2] = bars
        # The axis of the lens is in the middle of both; distortion is in half diagonals.
        grown = (projection.middle(size)[1] / projection.middle(self.size)[1]) ** 2
        by = np.diag([*np.ones(7), grown, grown**2])
        error = self.error
        if error is not None:
            error = replace(error, shared=by @ error.shared @ by, own=by @ error.own @ by)
        return replace(
            self, homography=moved @ self.homography, size=size, k1=grown * self.k1,
            k2=grown**2 * self.k2, error=error,
        )  # fmt: skip


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
