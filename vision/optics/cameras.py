"""Cameras of several pictures at once: each row of points has its own.

What a camera costs is the same for one point as for many; here it is the same for many cameras.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics import projection
from curlshot.vision.optics.camera import Camera

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cameras:
    """Cameras of n rows of points, from pictures of one size.

    Attributes
    ----------
    each : sequence of Camera
    row : ndarray of int, shape (n,)
        Which of them is that of each row.
    homography : ndarray, shape (n, 3, 3)
    k1, k2, f_px : ndarray, shape (n,)
    position : ndarray, shape (n, 3)
        Infinitely high where it is not known: then heights are ignored.
    """

    each: Sequence[Camera]
    row: NDArray[np.intp]
    homography: Array
    k1: Array
    k2: Array
    f_px: Array
    position: Array

    @classmethod
    def of(cls, cameras: Sequence[Camera], counts: Sequence[int]) -> Cameras:
        """Take each of the cameras for so many rows."""
        row = np.repeat(np.arange(len(cameras)), counts)
        nowhere = np.array([0.0, 0.0, np.inf])
        places = [nowhere if c.position is None else c.position for c in cameras]
        k1, k2, f_px = np.array([(c.k1, c.k2, c.f_px) for c in cameras])[row].T
        homography = np.array([c.homography for c in cameras])[row]
        return cls(cameras, row, homography, k1, k2, f_px, np.array(places)[row])

    @property
    def size(self) -> projection.Size:
        """Width and height of the pictures, px."""
        return self.each[0].size

    def project(self, ice: Array, height: Array | float = 0.0) -> Array:
        """As `Camera.project`, of points of shape (n, m, 2)."""
        on_ice = projection.behind(ice, height, self.position[:, None]) if np.any(height) else ice
        q = on_ice @ np.swapaxes(self.homography[..., :2], 1, 2) + self.homography[:, None, :, 2]
        for axis in (0, 1):  # several times as fast as both at once
            q[..., axis] /= q[..., 2]
        seen = q[..., :2]
        if not (self.k1.any() or self.k2.any()):
            return seen
        return projection.distort(seen, self.k1[:, None], self.k2[:, None], self.size)

    def ice(self, pixels: Array, height: float = 0.0) -> Array:
        """As `Camera.ice`, of pixels of shape (n, 2)."""
        straight = projection.undistort(pixels, self.k1, self.k2, self.size)
        back = np.linalg.inv(self.homography)
        q = (back[..., :2] @ straight[..., None])[..., 0] + back[..., 2]
        xy = q[:, :2] / q[:, 2:]
        return np.asarray(xy + (self.position[:, :2] - xy) * (height / self.position[:, 2:]))

    def scale_at(self, ice: Array) -> Array:
        """As `Camera.scale_at`, of points of shape (n, 2)."""
        return projection.scale_of(self.project(ice[:, None] + projection.AROUND))

    def slants(self, ice: Array) -> Array:
        """Slant of the view of points, (n, 2): how far it goes aside per metre down.

        Its length is the tangent of the angle to the vertical; 0 where that is unknown.
        """
        return np.asarray((ice - self.position[:, :2]) / self.position[:, 2:])

    def shared_place_cov(self, ice: Array, height: float = 0.0) -> Array:
        """As `Camera.shared_place_cov`, of points of shape (n, 2)."""
        found = np.zeros((len(ice), 2, 2))
        told = np.flatnonzero(np.array([c.error is not None for c in self.each], bool)[self.row])
        if not len(told):
            return found
        errors = [c.error for c in self.each if c.error is not None]
        which = np.cumsum([c.error is not None for c in self.each])[self.row[told]] - 1
        shared = np.array([error.shared for error in errors])[which]
        scale, drift = np.array([(error.scale, error.drift) for error in errors])[which].T
        away = np.column_stack([ice[told], np.full(len(told), height)]) - self.position[told]
        k1, k2, f_px = self.k1[told], self.k2[told], self.f_px[told]
        turned = projection.rotation(self.homography[told], f_px, self.size)
        by_camera = projection.place_jacobian(
            away, turned, f_px / projection.middle(self.size)[1], k1, k2
        )
        found[told] = projection.shared_place_cov(ice[told], by_camera, shared, scale, drift)
        return found
