"""A camera with a place: rotation and focal length per frame, the rest shared by a clip.

With the shared part (`curlshot.vision.optics.rig`) a frame's `View` says where every point of the
ice appears in the picture.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.vision.optics.camera import Camera, CameraError
from curlshot.vision.optics.rig import POSITION, distortion

Array = NDArray[np.float64]

DOWN = np.diag([1.0, -1.0, -1.0])
"""Rotation of a camera that looks straight down with y up in the picture."""

VIEW_SIZE = 4

ROLL = 2
"""Where in a view's vector the turn about the camera's own axis lies, for one that looks down."""


@dataclass(frozen=True, slots=True)
class View:
    """One frame's own part: rotation vector (rad, from straight down and upright), log f_px."""

    vector: Array

    @property
    def rotation(self) -> Array:
        """Ice axes to camera axes (x right, y down, z forward), shape (3, 3)."""
        return rotation_matrix(self.vector)

    @property
    def focal(self) -> float:
        """Focal length, px."""
        return float(np.exp(self.vector[3]))

    def aside(self, other: View) -> float:
        """How far turning from another view moves the picture, px."""
        return float(np.abs(self.vector - other.vector)[:3].max() * self.focal)

    def sweep(self, other: View) -> Array:
        """How far turning from another view moves the picture's middle along x and y, px."""
        turn = turning(self.vector) @ (self.vector - other.vector)[:3]
        return self.focal * np.array([turn[1], -turn[0]])


def rotation_matrix(vector: Array) -> Array:
    """Ice axes to camera axes (x right, y down, z forward), shape (3, 3), from a view's vector.

    Rodrigues' formula, followed by the camera that looks straight down.
    """
    x, y, z = float(vector[0]), float(vector[1]), float(vector[2])
    square = x * x + y * y + z * z
    a, b, _ = _series(square)
    c = 1.0 - b * square
    return np.array(
        [
            [c + b * x * x, a * z - b * x * y, -a * y - b * x * z],
            [a * z + b * x * y, -c - b * y * y, a * x - b * y * z],
            [b * x * z - a * y, -a * x - b * y * z, -c - b * z * z],
        ]
    )


def turning(vector: Array) -> Array:
    """Change of the rotation, as a turn about the camera's axes, by the view's first three.

    Left Jacobian of the rotation group, shape (3, 3): Barfoot, State Estimation for Robotics,
    2017, equation 7.77.
    """
    x, y, z = float(vector[0]), float(vector[1]), float(vector[2])
    square = x * x + y * y + z * z
    a, b, c = _series(square)
    return np.array(
        [
            [a + c * x * x, c * x * y - b * z, c * x * z + b * y],
            [c * x * y + b * z, a + c * y * y, c * y * z - b * x],
            [c * x * z - b * y, c * y * z + b * x, a + c * z * z],
        ]
    )


def _series(square: float) -> tuple[float, float, float]:
    """Sin t / t, (1 − cos t) / t² and (t − sin t) / t³ for t² = `square`."""
    if square < 1e-4:
        return 1 - square / 6, 0.5 - square / 24, 1 / 6 - square / 120
    t = math.sqrt(square)
    return math.sin(t) / t, (1 - math.cos(t)) / square, (t - math.sin(t)) / (square * t)


def project(ice: Array, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    """Ice points to pixels.

    Parameters
    ----------
    ice : ndarray, shape (n, 2)
        Places on the ice, m.
    view : ndarray, shape (4,)
        A `View`'s vector.
    rig : ndarray, shape (15,)
    size : tuple of int
        Width and height of the picture, px.

    Returns
    -------
    ndarray, shape (n, 2)
        NaN behind the camera.
    """
    rotation = rotation_matrix(view)
    p = rotation[:, :2] @ ice.T - (rotation @ rig[POSITION])[:, None]  # rows: fast for many points
    z = np.where(p[2] > 1e-3, p[2], np.nan)
    w, h = size
    diagonal = math.hypot(w, h) / 2
    q = p[:2] * (math.exp(view[3]) / diagonal / z)
    k1, k2 = distortion(rig, view[3], size)
    r2 = q[0] * q[0] + q[1] * q[1]
    q *= diagonal * (1 + r2 * (k1 + k2 * r2))
    q += [[(w - 1) / 2], [(h - 1) / 2]]
    return np.asarray(q.T)


def pictured(
    ice: Array, view: Array, rig: Array, size: tuple[int, int]
) -> tuple[Array, NDArray[np.bool_]]:
    """As `project` for places of shape (..., 2), and which of them lie in the picture, (...)."""
    place = project(ice.reshape(-1, 2), view, rig, size).reshape(ice.shape)
    with np.errstate(invalid="ignore"):
        return place, np.asarray(((place > 0) & (place < np.array(size) - 1)).all(-1))


def camera(
    view: View,
    rig: Array,
    size: tuple[int, int],
    *,
    frame: int = 0,
    t: float = 0.0,
    rms_px: float = float("nan"),
    found: bool = True,
    error: CameraError | None = None,
    quality: float = float("nan"),
) -> Camera:
    """Give the frame's `Camera`, with the homography K [r1 r2 −R C]."""
    w, h = size
    f = view.focal
    k = np.array([[f, 0, (w - 1) / 2], [0, f, (h - 1) / 2], [0, 0, 1]])
    r = view.rotation
    r[:, 2] = -r @ rig[POSITION]
    matrix = k @ r
    k1, k2 = distortion(rig, view.vector[3], size)
    return Camera(
        frame,
        t,
        matrix / matrix[2, 2],
        size,
        k1,
        k2,
        f,
        rig[POSITION].copy(),
        rms_px,
        found,
        error,
        quality,
    )


def aim(centre: ArrayLike, scale: float, position: ArrayLike, size: tuple[int, int]) -> View:
    """View of an upright camera at `position` that has the tee at `centre`, `scale` px/m there."""
    c = np.asarray(position, float)
    distance = float(np.linalg.norm(c))
    u = np.asarray(centre, float) - [(size[0] - 1) / 2, (size[1] - 1) / 2]
    f = scale * distance
    for _ in range(5):  # off the axis a picture is stretched: 1/cos² outwards, 1/cos across
        f = scale * distance * float(np.cos(np.arctan2(np.hypot(*u), f))) ** 1.5
        f = max(f, float(np.hypot(*u)))
    forward = -c / distance
    right = np.array([1.0, 0.0, 0.0]) - forward[0] * forward
    right /= np.linalg.norm(right)
    look = np.stack([right, np.cross(forward, right), forward])
    ray = np.array([u[0] / f, u[1] / f, 1.0])
    ray /= np.linalg.norm(ray)
    axis = np.cross([0.0, 0.0, 1.0], ray)
    angle = float(np.arctan2(np.linalg.norm(axis), ray[2]))
    turn = cv2.Rodrigues(axis / max(float(np.linalg.norm(axis)), 1e-12) * angle)[0]
    vector = rotation_vector(np.asarray(turn) @ look @ DOWN.T)
    return View(np.append(vector, np.log(f)))


def rotation_vector(matrix: Array) -> Array:
    """Axis of a rotation matrix times its angle, rad, shape (3,).

    By the quaternion, of which the matrix tells all products (Bar-Itzhack, 2000, J. Guid.
    Control Dyn. 23, 1085): `cv2.Rodrigues` loses half the digits near the identity.
    """
    trace = float(np.trace(matrix))
    products = np.empty((4, 4))
    products[0, 0] = 1 + trace
    products[0, 1:] = products[1:, 0] = (matrix - matrix.T)[[2, 0, 1], [1, 2, 0]]
    products[1:, 1:] = matrix + matrix.T + (1 - trace) * np.eye(3)
    quaternion = products[products.diagonal().argmax()]
    quaternion = quaternion * np.copysign(1.0, quaternion[0])
    size = float(np.linalg.norm(quaternion[1:]))
    angle = 2 * float(np.arctan2(size, quaternion[0]))
    return np.asarray(quaternion[1:] * (angle / size if size > 0 else 0.0))


def turned(view: View, rig: Array, angle: float) -> tuple[View, Array]:
    """Turn the ice's axes by `angle` (rad, ccw); a picture of circles stays the same."""
    c, s = np.cos(angle), np.sin(angle)
    spin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    vector = rotation_vector(view.rotation @ spin @ DOWN.T)
    moved = rig.copy()
    moved[POSITION] = spin.T @ rig[POSITION]
    return View(np.append(vector, view.vector[3])), moved


def rescaled(view: View, factor: float) -> View:
    """Give the same view of a picture `factor` times as large."""
    vector = view.vector.copy()
    vector[3] += np.log(factor)
    return replace(view, vector=vector)
