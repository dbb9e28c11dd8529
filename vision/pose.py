"""A camera with a place: rotation and focal length per frame, the rest shared by a clip.

The marks of a frame (edge points of the painted circles and lines, in pixels) fix the camera by
robust least squares. What a clip shares (place of the camera, distortion, painted radii) and what
each frame has for itself (rotation, focal length) are solved together; the frames are eliminated
one by one (Schur complement), so that the cost grows with the number of frames only linearly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from data.sheet import HOUSE
from vision.camera import Camera

Array = NDArray[np.float64]

CIRCLES = 3
TWELVE, EIGHT, FOUR, CENTRE_LINE, TEE_LINE, LEFT, RIGHT = range(7)
"""What a mark lies on: the three circles, the two lines through the tee, the sheet's sides."""

_DOWN = np.diag([1.0, -1.0, -1.0])
"""Rotation of a camera that looks straight down with y up in the picture."""

POSITION, K1, K1_ZOOM, K2, R8, R4, SIDE_L, SIDE_R = slice(0, 3), 3, 4, 5, 6, 7, 8, 9
RIG_SIZE = 10
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
    """Gaussian prior of the rig: mean and standard deviation, shape (10,) each.

    Order: position x, y, z (m); k1, its change per unit of log focal length, k2; radii of the
    8-ft and 4-ft edges (m); place x of the left and the right side of the sheet (m).
    """

    mean: Array
    sd: Array


_PAINT = ((0.0, 0.05), (0.0, 0.05), (0.0, 0.02))  # k1, k1 by zoom, k2 (see design of broadcasts)
_RADII = ((1.2135, 0.008), (0.619, 0.009))  # measured on fourteen painted houses
_SIDES = ((-2.35, 0.1), (2.35, 0.1))


def _prior(*position: tuple[float, float]) -> Prior:
    rows = np.array([*position, *_PAINT, *_RADII, *_SIDES])
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
        return np.asarray(cv2.Rodrigues(self.vector[:3])[0]) @ _DOWN

    @property
    def focal(self) -> float:
        """Focal length, px."""
        return float(np.exp(self.vector[3]))


@dataclass(frozen=True)
class Solution:
    """Result of `solve`.

    Attributes
    ----------
    rig : ndarray, shape (10,)
        Shared part, in the order of `Prior`.
    views : tuple of View
        One per frame.
    rig_cov : ndarray, shape (10, 10)
        Covariance of the shared part; zero where it was held.
    rms : ndarray
        Residual of the inlying marks per frame, px.
    inliers : tuple of ndarray of bool
        Marks within reach of the model, per frame.
    cost : float
        Half the robust sum of squares with the prior's part.
    """

    rig: Array
    views: tuple[View, ...]
    rig_cov: Array
    rms: Array
    inliers: tuple[NDArray[np.bool_], ...]
    cost: float


def ice_points(line: NDArray[np.int64], along: ArrayLike, rig: Array) -> Array:
    """Places of marks on the ice, shape (n, 2), m."""
    s = np.asarray(along, float)
    radius = np.array([HOUSE.twelve_foot, rig[R8], rig[R4]])
    x_of = np.array([0.0, 0.0, rig[SIDE_L], rig[SIDE_R]])
    circle = line < CIRCLES
    r = radius[np.where(circle, line, 0)]
    x = np.where(circle, r * np.cos(s), x_of[np.where(circle, 0, line - CIRCLES)])
    y = np.where(circle, r * np.sin(s), s)
    across = line == TEE_LINE
    place = np.stack([np.where(across, s, x), np.where(across, 0.0, y)], axis=-1)
    return np.asarray(place, np.float64)


def distortion(rig: Array, log_f: float, size: tuple[int, int]) -> tuple[float, float]:
    """Radial terms k1, k2 at a focal length; k1 goes with the zoom."""
    zoom = log_f - np.log(2.0 * size[0])
    return float(rig[K1] + rig[K1_ZOOM] * zoom), float(rig[K2])


def project(ice: Array, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    """Ice points, shape (n, 2), to pixels; points behind the camera go to infinity."""
    rotation = np.asarray(cv2.Rodrigues(view[:3])[0]) @ _DOWN
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
) -> Camera:
    """Give the frame's `Camera`, with the homography K [r1 r2 −R C]."""
    w, h = size
    f = view.focal
    k = np.array([[f, 0, (w - 1) / 2], [0, f, (h - 1) / 2], [0, 0, 1]])
    r = view.rotation
    matrix = k @ np.column_stack([r[:, 0], r[:, 1], -r @ rig[POSITION]])
    k1, k2 = distortion(rig, view.vector[3], size)
    return Camera(
        frame, t, matrix / matrix[2, 2], size, k1, k2, f, rig[POSITION].copy(), rms_px, found
    )


def aim(centre: ArrayLike, scale: float, position: ArrayLike, size: tuple[int, int]) -> View:
    """View of an upright camera at `position` that has the tee at `centre`, `scale` px/m there."""
    c = np.asarray(position, float)
    distance = float(np.linalg.norm(c))
    u = np.asarray(centre, float) - [(size[0] - 1) / 2, (size[1] - 1) / 2]
    f = scale * distance
    for _ in range(5):  # off the axis a picture is stretched: 1/cos² outwards, 1/cos across
        f = scale * distance * float(np.cos(np.arctan2(np.hypot(*u), f))) ** 1.5
    forward = -c / distance
    right = np.array([1.0, 0.0, 0.0]) - forward[0] * forward
    right /= np.linalg.norm(right)
    look = np.stack([right, np.cross(forward, right), forward])
    ray = np.array([u[0] / f, u[1] / f, 1.0])
    ray /= np.linalg.norm(ray)
    axis = np.cross([0.0, 0.0, 1.0], ray)
    angle = float(np.arctan2(np.linalg.norm(axis), ray[2]))
    turn = cv2.Rodrigues(axis / max(float(np.linalg.norm(axis)), 1e-12) * angle)[0]
    vector = cv2.Rodrigues(np.asarray(turn) @ look @ _DOWN.T)[0].ravel()
    return View(np.append(vector, np.log(f)))


def turned(view: View, rig: Array, angle: float) -> tuple[View, Array]:
    """Turn the ice's axes by `angle` (rad, ccw); a picture of circles stays the same."""
    c, s = np.cos(angle), np.sin(angle)
    spin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    vector = cv2.Rodrigues(view.rotation @ spin @ _DOWN.T)[0].ravel()
    moved = rig.copy()
    moved[POSITION] = spin.T @ rig[POSITION]
    return View(np.append(vector, view.vector[3])), moved


_STEP_VIEW = np.array([1e-5, 1e-5, 1e-5, 1e-5])
_STEP_RIG = np.array([1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 1e-5, 1e-5])


def _residuals(marks: Marks, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    model = project(ice_points(marks.line, marks.along, rig), view, rig, size)
    r = ((model - marks.pixel) * marks.normal).sum(-1) / marks.sd
    return np.where(np.isfinite(r), r, 1e6)


def _slopes(
    marks: Marks, view: Array, rig: Array, size: tuple[int, int], free: NDArray[np.int64]
) -> tuple[Array, Array]:
    """Differentiate the residuals by the view and by the free part of the rig."""
    by_view = np.empty((len(marks), VIEW_SIZE))
    for i, step in enumerate(_STEP_VIEW):
        d = np.zeros(VIEW_SIZE)
        d[i] = step
        ahead = _residuals(marks, view + d, rig, size)
        by_view[:, i] = (ahead - _residuals(marks, view - d, rig, size)) / (2 * step)
    by_rig = np.empty((len(marks), len(free)))
    for column, i in enumerate(free):
        d = np.zeros(RIG_SIZE)
        d[i] = _STEP_RIG[i]
        ahead = _residuals(marks, view, rig + d, size)
        by_rig[:, column] = (ahead - _residuals(marks, view, rig - d, size)) / (2 * d[i])
    return by_view, by_rig


def _robust(r: Array, width: float) -> tuple[Array, float]:
    """Cauchy weights and cost of residuals in standard deviations."""
    scaled = (r / width) ** 2
    return 1 / (1 + scaled), float(0.5 * width**2 * np.log1p(scaled).sum())


def solve(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    *,
    prior: Prior | None = None,
    view_sd: ArrayLike = (np.inf, np.inf, 0.15, np.inf),
    width: float = 3.0,
    iterations: int = 12,
) -> Solution:
    """Fit cameras to the marks of one or more frames by robust least squares.

    Parameters
    ----------
    frames : sequence of Marks
    views : sequence of View
        Start values, one per frame, and the centres of the weak prior `view_sd`.
    rig : ndarray, shape (10,)
        Shared part: start values if `prior` is given, else held as it is.
    prior : Prior, optional
        Makes the rig an unknown.
    view_sd : array_like, shape (4,)
        Standard deviation of each view about its start (the roll is free where no line is seen).
    width : float
        Width of the Cauchy loss in standard deviations.
    """
    free = np.arange(RIG_SIZE) if prior is not None else np.arange(0)
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = [v.vector.copy() for v in views]
    now, shared = [v.copy() for v in start], rig.copy()

    def total(vs: Sequence[Array], s: Array) -> float:
        value = 0.0
        for marks, v, v0 in zip(frames, vs, start, strict=True):
            value += _robust(_residuals(marks, v, s, size), width)[1]
            value += 0.5 * float((hold * (v - v0) ** 2).sum())
        if prior is not None:
            value += 0.5 * float((((s - prior.mean) / prior.sd) ** 2).sum())
        return value

    cost, damping = total(now, shared), 1e-4
    schur = np.eye(len(free))
    for _ in range(iterations):
        blocks = []
        schur, right = np.zeros((len(free), len(free))), np.zeros(len(free))
        if prior is not None:
            schur += np.diag(1 / prior.sd**2)
            right += (shared - prior.mean) / prior.sd**2
        for marks, v, v0 in zip(frames, now, start, strict=True):
            r = _residuals(marks, v, shared, size)
            weight = _robust(r, width)[0][:, None]
            jv, js = _slopes(marks, v, shared, size, free)
            vv = (jv * weight).T @ jv + np.diag(hold)
            vv += np.diag(damping * np.diag(vv) + 1e-9)
            vs = (jv * weight).T @ js
            gv = (jv * weight).T @ r + hold * (v - v0)
            eliminate = np.linalg.solve(vv, np.column_stack([vs, gv]))
            schur += (js * weight).T @ js - vs.T @ eliminate[:, :-1]
            right += (js * weight).T @ r - vs.T @ eliminate[:, -1]
            blocks.append(eliminate)
        step = -np.linalg.solve(schur, right) if len(free) else np.zeros(0)
        moved = shared.copy()
        moved[free] += step
        tried = [v - b[:, -1] - b[:, :-1] @ step for v, b in zip(now, blocks, strict=True)]
        new = total(tried, moved)
        if not new <= cost:
            damping *= 10
            if damping > 1e4:
                break
            continue
        done = cost - new < 1e-4 * (1 + cost)
        now, shared, cost, damping = tried, moved, new, max(damping / 10, 1e-9)
        if done:
            break
    cov = np.zeros((RIG_SIZE, RIG_SIZE))
    if len(free):
        cov[np.ix_(free, free)] = np.linalg.inv(schur)
    rms, inliers = [], []
    for marks, v in zip(frames, now, strict=True):
        r = _residuals(marks, v, shared, size)
        good = np.abs(r) < width
        inliers.append(good)
        px = (r * marks.sd)[good]
        rms.append(float(np.sqrt(np.mean(px**2))) if len(px) else float("nan"))
    return Solution(
        shared, tuple(View(v) for v in now), cov, np.array(rms), tuple(inliers), float(cost)
    )


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
