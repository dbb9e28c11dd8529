"""A camera with a place: rotation and focal length per frame, the rest shared by a clip.

The shared part (the rig) is an array: place of the camera, distortion, painted radii, sides of
the sheet. With a frame's `View` it says where every point of the ice appears in the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from data.sheet import HOUSE
from vision.camera import Camera, PlaceError

Array = NDArray[np.float64]

CIRCLES = 3
TWELVE, EIGHT, FOUR, CENTRE_LINE, TEE_LINE, LEFT, RIGHT = range(7)
"""What a mark lies on: the three circles, the two lines through the tee, the sheet's sides."""

DOWN = np.diag([1.0, -1.0, -1.0])
"""Rotation of a camera that looks straight down with y up in the picture."""

POSITION, K1, K1_ZOOM, K2, R8, R4, SIDE_L, SIDE_R = slice(0, 3), 3, 4, 5, 6, 7, 8, 9
CENTRE_X, TEE_Y = 10, 11
RIG_SIZE = 12
VIEW_SIZE = 4


@dataclass(frozen=True)
class Marks:
    """Edge points measured in one frame.

    Attributes
    ----------
    line : ndarray of int, shape (n,)
        What each point lies on (`TWELVE` … `RIGHT`).
    along : ndarray, shape (n,)
        Angle on a circle, rad; else the coordinate along the line, m.
    pixel, normal : ndarray, shape (n, 2)
        Measured place and the unit normal along which it was measured, px.
    sd : ndarray, shape (n,)
        Standard deviation along the normal, px.
    """

    line: NDArray[np.int64]
    along: Array
    pixel: Array
    normal: Array
    sd: Array

    def __len__(self) -> int:
        return len(self.line)

    def pick(self, which: NDArray[np.bool_]) -> Marks:
        """Pick the marks for which `which` is True."""
        return Marks(
            self.line[which],
            self.along[which],
            self.pixel[which],
            self.normal[which],
            self.sd[which],
        )


def joined(parts: Sequence[Marks]) -> Marks:
    """Join marks of several kinds into one."""
    if not parts:
        none = np.zeros((0, 2))
        return Marks(np.zeros(0, np.int64), np.zeros(0), none, none.copy(), np.zeros(0))
    return Marks(
        np.concatenate([p.line for p in parts]),
        np.concatenate([p.along for p in parts]),
        np.concatenate([p.pixel for p in parts]),
        np.concatenate([p.normal for p in parts]),
        np.concatenate([p.sd for p in parts]),
    )


@dataclass(frozen=True)
class Prior:
    """Gaussian prior of the rig: mean and standard deviation, shape (12,) each.

    Order: position x, y, z (m); k1, its change per unit of log focal length, k2; radii of the
    8-ft and 4-ft edges (m); x of the left and the right side of the sheet, x of the centre line
    and y of the tee line (m).
    """

    mean: Array
    sd: Array


_LENS = ((-0.015, 0.05), (0.0, 0.05), (0.01, 0.02))  # k1, k1 by zoom, k2: broadcast lenses
_RADII = ((1.2135, 0.005), (0.619, 0.006))  # measured on fourteen painted houses
_SIDES = ((-2.35, 0.1), (2.35, 0.1))
_CROSS = ((0.0, 0.008), (0.0, 0.008))  # a line may be two stripes, of which one is measured


def _prior(*position: tuple[float, float]) -> Prior:
    rows = np.array([*position, *_LENS, *_RADII, *_SIDES, *_CROSS])
    return Prior(rows[:, 0].copy(), rows[:, 1].copy())


OVERHEAD = _prior((0.0, 0.35), (0.0, 0.35), (8.5, 1.5))
"""Broadcast cameras hang 6 to 11 m above the ice, within 0.5 m of plumb over the tee."""

ANYWHERE = _prior((0.0, 8.0), (0.0, 12.0), (7.0, 5.0))
"""A camera of which nothing is known but that it is above the ice."""


@dataclass(frozen=True)
class View:
    """One frame's own part: rotation vector (rad, from straight down and upright), log f_px."""

    vector: Array

    @property
    def rotation(self) -> Array:
        """Ice axes to camera axes (x right, y down, z forward), shape (3, 3)."""
        return np.asarray(cv2.Rodrigues(self.vector[:3])[0], np.float64) @ DOWN

    @property
    def focal(self) -> float:
        """Focal length, px."""
        return float(np.exp(self.vector[3]))


def ice_points(line: NDArray[np.int64], along: ArrayLike, rig: Array) -> Array:
    """Places of marks on the ice, shape (n, 2), m."""
    place, way = ice_frame(line, np.asarray(along, float))
    return np.asarray(place + way * measures(rig)[line][:, None])


def measures(rig: Array) -> Array:
    """List the measure of each kind of mark: radius of a circle or place of a line, m."""
    return np.array([HOUSE.twelve_foot, *rig[[R8, R4, CENTRE_X, TEE_Y, SIDE_L, SIDE_R]]])


def ice_frame(line: NDArray[np.int64], along: Array) -> tuple[Array, Array]:
    """Foot of each mark and the direction in which its line's measure moves it, (n, 2) each."""
    place, way = np.zeros((len(line), 2)), np.zeros((len(line), 2))
    circle, across = line < CIRCLES, line == TEE_LINE
    way[:, 0] = np.where(circle, np.cos(along), ~across)
    way[:, 1] = np.where(circle, np.sin(along), across)
    place[:, 0] = np.where(across, along, 0.0)
    place[:, 1] = np.where(circle | across, 0.0, along)
    return place, way


def distortion(rig: Array, log_f: float, size: tuple[int, int]) -> tuple[float, float]:
    """Radial terms k1, k2 at a focal length; k1 goes with the zoom."""
    return float(rig[K1] + rig[K1_ZOOM] * zoom(log_f, size)), float(rig[K2])


def zoom(log_f: float, size: tuple[int, int]) -> float:
    """Log focal length over twice the picture's width: 0 in the midst of what is usual."""
    return float(log_f - np.log(2.0 * size[0]))


def project(ice: Array, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    """Ice points, shape (n, 2), to pixels; points behind the camera go to infinity."""
    rotation = np.asarray(cv2.Rodrigues(view[:3])[0]) @ DOWN
    p = ice @ rotation[:, :2].T - rotation @ rig[POSITION]
    z = np.where(p[:, 2] > 1e-3, p[:, 2], np.nan)
    w, h = size
    diagonal = np.hypot(w, h) / 2
    q = p[:, :2] * (np.exp(view[3]) / diagonal / z)[:, None]
    k1, k2 = distortion(rig, view[3], size)
    r2 = (q**2).sum(-1, keepdims=True)
    return np.asarray([(w - 1) / 2, (h - 1) / 2] + diagonal * q * (1 + r2 * (k1 + k2 * r2)))


def camera(
    view: View,
    rig: Array,
    size: tuple[int, int],
    *,
    frame: int = 0,
    t: float = 0.0,
    rms_px: float = float("nan"),
    found: bool = True,
    place_error: PlaceError | None = None,
) -> Camera:
    """Give the frame's `Camera`, with the homography K [r1 r2 −R C]."""
    w, h = size
    f = view.focal
    k = np.array([[f, 0, (w - 1) / 2], [0, f, (h - 1) / 2], [0, 0, 1]])
    r = view.rotation
    matrix = k @ np.column_stack([r[:, 0], r[:, 1], -r @ rig[POSITION]])
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
        place_error,
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
    vector = _rotation_vector(np.asarray(turn) @ look @ DOWN.T)
    return View(np.append(vector, np.log(f)))


def _rotation_vector(matrix: Array) -> Array:
    # Not by cv2.Rodrigues, which loses half the digits near the identity.
    return np.asarray(Rotation.from_matrix(matrix).as_rotvec())


def turned(view: View, rig: Array, angle: float) -> tuple[View, Array]:
    """Turn the ice's axes by `angle` (rad, ccw); a picture of circles stays the same."""
    c, s = np.cos(angle), np.sin(angle)
    spin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    vector = _rotation_vector(view.rotation @ spin @ DOWN.T)
    moved = rig.copy()
    moved[POSITION] = spin.T @ rig[POSITION]
    return View(np.append(vector, view.vector[3])), moved


def rescaled(view: View, factor: float) -> View:
    """Give the same view of a picture `factor` times as large."""
    vector = view.vector.copy()
    vector[3] += np.log(factor)
    return replace(view, vector=vector)


def start_rig(prior: Prior, position: ArrayLike | None = None) -> Array:
    """Start at the prior's mean, at another position if given."""
    rig = prior.mean.copy()
    if position is not None:
        rig[POSITION] = position
    return rig
