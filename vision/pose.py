"""A camera with a place: rotation and focal length per frame, the rest shared by a clip.

The shared part (the rig) is an array: place of the camera, distortion, painted radii, sides of
the sheet. With a frame's `View` it says where every point of the ice appears in the picture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from data.sheet import HOUSE, SHEET
from vision.camera import Camera, CameraError

Array = NDArray[np.float64]
Log = TypeVar("Log", float, Array)

CIRCLES = 3
TWELVE, EIGHT, FOUR, CENTRE_LINE, TEE_LINE, LEFT, RIGHT, BACK_LINE, HOG_LINE, FIXED = range(10)
"""What a mark lies on: the three circles, the two lines through the tee, the sheet's sides, the
lines across it behind and before the house; or a point of the ice whose place is known."""

DOWN = np.diag([1.0, -1.0, -1.0])
"""Rotation of a camera that looks straight down with y up in the picture."""

POSITION, K1, K1_ZOOM, K2, R8, R4, SIDE_L, SIDE_R = slice(0, 3), 3, 4, 5, 6, 7, 8, 9
CENTRE_X, TEE_Y, BACK_Y, HOG_Y = 10, 11, 12, 13
RIG_SIZE = 14
VIEW_SIZE = 4


@dataclass(frozen=True)
class Marks:
    """Edge points measured in one frame.

    Attributes
    ----------
    line : ndarray of int, shape (n,)
        What each point lies on (`TWELVE` … `FIXED`).
    along : ndarray, shape (n,)
        Angle on a circle, rad; the coordinate along a line, m; x of a fixed point, m.
    pixel, normal : ndarray, shape (n, 2)
        Measured place and the unit normal along which it was measured, px.
    sd : ndarray, shape (n,)
        Standard deviation along the normal, px.
    across : ndarray, shape (n,), optional
        y of a fixed point, m; without meaning for the other kinds. None where there are no fixed
        points.
    """

    line: NDArray[np.int64]
    along: Array
    pixel: Array
    normal: Array
    sd: Array
    across: Array | None = None

    def __len__(self) -> int:
        return len(self.line)

    def pick(self, which: NDArray[np.bool_] | NDArray[np.int64]) -> Marks:
        """Pick the marks for which `which` is True, or those of these indices."""
        return Marks(
            self.line[which],
            self.along[which],
            self.pixel[which],
            self.normal[which],
            self.sd[which],
            None if self.across is None else self.across[which],
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
        None
        if all(p.across is None for p in parts)
        else np.concatenate([np.zeros(len(p)) if p.across is None else p.across for p in parts]),
    )


def fixed(ice: Array, pixel: Array, sd: ArrayLike) -> Marks:
    """Points of the ice at known places, shape (n, 2), m, seen at pixels: two marks for each."""
    count = len(ice)
    return Marks(
        np.full(2 * count, FIXED),
        np.tile(ice[:, 0], 2),
        np.tile(pixel, (2, 1)),
        np.repeat(np.eye(2), count, axis=0),
        np.tile(np.broadcast_to(np.asarray(sd, float), count), 2),
        np.tile(ice[:, 1], 2),
    )


@dataclass(frozen=True)
class Prior:
    """Gaussian prior of the rig: mean and standard deviation, shape (14,) each.

    Order: position x, y, z (m); k1, its change per unit of log focal length, k2; radii of the
    8-ft and 4-ft edges (m); x of the left and the right side of the sheet, x of the centre line,
    y of the tee line, of the back line and of the hog line (m).
    """

    mean: Array
    sd: Array


_LENS = ((-0.015, 0.05), (0.0, 0.05), (0.01, 0.02))  # k1, k1 by zoom, k2: broadcast lenses
_RADII = ((1.2135, 0.005), (0.619, 0.006))  # measured on fourteen painted houses
_SIDES = ((-2.35, 0.1), (2.35, 0.1))
_CROSS = ((0.0, 0.008), (0.0, 0.008))  # a line may be two stripes, of which one is measured
_ACROSS = ((-SHEET.back_line, 0.015), (SHEET.hog_line, 0.06))  # of a wide line one edge may be


def _prior(*position: tuple[float, float]) -> Prior:
    rows = np.array([*position, *_LENS, *_RADII, *_SIDES, *_CROSS, *_ACROSS])
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
        return rotation_matrix(self.vector)

    @property
    def focal(self) -> float:
        """Focal length, px."""
        return float(np.exp(self.vector[3]))


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


def ice_points(
    line: NDArray[np.int64], along: ArrayLike, rig: Array, across: Array | None = None
) -> Array:
    """Places of marks on the ice, shape (n, 2), m."""
    place, way = ice_frame(line, np.asarray(along, float), across)
    return np.asarray(place + way * measures(rig)[line][:, None])


MEASURED = np.array([-1, R8, R4, CENTRE_X, TEE_Y, SIDE_L, SIDE_R, BACK_Y, HOG_Y, -1])
"""Per kind of mark the unknown of the rig that is its measure; −1 where that is known."""


def measures(rig: Array) -> Array:
    """List the measure of each kind of mark: radius of a circle or place of a line, m."""
    return np.array([HOUSE.twelve_foot, *rig[MEASURED[1:-1]], 0.0])


_FACTORS = np.zeros((4, 10))
_FACTORS[0, :CIRCLES] = 1.0  # circles
_FACTORS[1, [CENTRE_LINE, LEFT, RIGHT]] = 1.0  # lines along the sheet
_FACTORS[2, [TEE_LINE, BACK_LINE, HOG_LINE]] = 1.0  # lines across it
_FACTORS[3, FIXED] = 1.0


def ice_frame(
    line: NDArray[np.int64], along: Array, across: Array | None = None
) -> tuple[Array, Array]:
    """Foot of each mark and the direction in which its line's measure moves it, (n, 2) each."""
    circle, lengthwise, crosswise, known = _FACTORS[:, line]
    place, way = np.empty((len(line), 2)), np.empty((len(line), 2))
    way[:, 0] = circle * np.cos(along) + lengthwise
    way[:, 1] = circle * np.sin(along) + crosswise
    place[:, 0] = (crosswise + known) * along
    place[:, 1] = lengthwise * along
    if across is not None:
        place[:, 1] += known * across
    return place, way


def distortion(rig: Array, log_f: float, size: tuple[int, int]) -> tuple[float, float]:
    """Radial terms k1, k2 at a focal length; k1 goes with the zoom."""
    return float(rig[K1] + rig[K1_ZOOM] * zoom(log_f, size)), float(rig[K2])


def zoom(log_f: Log, size: tuple[int, int]) -> Log:
    """Log focal length over twice the picture's width: 0 in the midst of what is usual."""
    return log_f - math.log(2.0 * size[0])


def project(ice: Array, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    """Ice points, shape (n, 2), to pixels; points behind the camera go to infinity."""
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
