"""Cameras from marks, by robust least squares.

One frame's view with the shared part held (`solve_view`), or both together (`solve`): then the
frames are eliminated one by one (Schur complement), so that the cost grows only linearly with
their number. Triggs et al., 2000, Bundle adjustment: a modern synthesis, LNCS 1883, section 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vision.pose import (
    K1,
    K1_ZOOM,
    K2,
    MEASURED,
    POSITION,
    RIG_SIZE,
    VIEW_SIZE,
    Marks,
    Prior,
    View,
    distortion,
    ice_frame,
    measures,
    rotation_matrix,
    turning,
    zoom,
)

Array = NDArray[np.float64]

VIEW_SD = (np.inf, np.inf, 0.15, np.inf)
"""How far a view may lie from its start: the roll is free where no line is seen."""

WIDTH = 3.0
"""Width of the Cauchy loss, in standard deviations."""

_NEAR = 0.5
"""A step that lowers the cost by less is so short that linear residuals are exact at its end."""

REWEIGHTINGS = 2
"""Rounds of weights for one linearisation of a view."""

_FAR = 1e6
"""Residual, in standard deviations, of a point that the camera cannot see."""

_DONE = 1e-4
"""Relative fall of the cost below which a fit has converged."""


@dataclass(frozen=True)
class Solution:
    """Result of `solve`.

    Attributes
    ----------
    rig : ndarray, shape (14,)
        Shared part, in the order of `vision.pose.Prior`.
    views : tuple of View
        One per frame.
    rig_cov : ndarray, shape (14, 14)
        Covariance of the shared part; zero where it was held.
    rms : ndarray
        Residual of the inlying marks per frame, px; NaN where there are none.
    inliers : tuple of ndarray of bool
        Marks within reach of the model, per frame.
    cost : float
        Half the robust sum of squares, the priors' part included.
    """

    rig: Array
    views: tuple[View, ...]
    rig_cov: Array
    rms: Array
    inliers: tuple[NDArray[np.bool_], ...]
    cost: float


@dataclass(frozen=True)
class ViewSolution:
    """Result of `solve_view`.

    Attributes
    ----------
    view : View
    cov : ndarray, shape (4, 4)
        Covariance of the view, the shared part taken as known and the marks as independent.
    rms : float
        Residual of the inlying marks, px; NaN where there are none.
    inliers : ndarray of bool, shape (n,)
        Marks within reach of the model.
    cost : float
        Half the robust sum of squares.
    """

    view: View
    cov: Array
    rms: float
    inliers: NDArray[np.bool_]
    cost: float


class Frame:
    """One frame's marks in the form in which residuals are worked out, one column per mark."""

    def __init__(self, marks: Marks, size: tuple[int, int], offset: Array | float = 0.0) -> None:
        self.size = size
        self.radius = float(np.hypot(*size)) / 2
        self.sd = marks.sd
        self.line = marks.line
        place, way = ice_frame(marks.line, marks.along, marks.across)
        self.foot = np.zeros((3, len(marks)))
        self.way = np.ascontiguousarray(way.T)
        self.foot[:2] = place.T + self.way * offset
        normal = marks.normal.T / marks.sd
        middle = np.array([(size[0] - 1) / 2, (size[1] - 1) / 2])
        self.target = ((marks.pixel - middle).T * normal).sum(0)
        self.normal = normal * self.radius

    def points(self, rig: Array) -> Array:
        """Places of the marks relative to the camera, along the ice's axes, shape (3, n), m."""
        away = self.foot - rig[POSITION, None]
        away[:2] += self.way * measures(rig)[self.line]
        return away


@dataclass(frozen=True)
class Linear:
    """Residuals along the normals, in standard deviations, and what they follow from.

    Attributes
    ----------
    residual : ndarray, shape (n,)
    by_view : ndarray, shape (4, n)
        Derivatives by the view.
    by_point : ndarray, shape (3, n)
        Derivatives by the point in the camera's axes.
    by_k1 : ndarray, shape (n,)
        Derivative by k1; `r2` times that is the one by k2.
    r2 : ndarray, shape (n,)
        |q|² of the undistorted point.
    rotation : ndarray, shape (3, 3)
    """

    residual: Array
    by_view: Array
    by_point: Array
    by_k1: Array
    r2: Array
    rotation: Array


def linearised(frame: Frame, points: Array, view: Array, rig: Array) -> Linear:
    """Residuals of a frame's marks at `points` (see `Frame.points`), and derivatives."""
    rotation = rotation_matrix(view)
    p = rotation @ points
    z = p[2]
    hidden = z <= 1e-3
    blind = bool(hidden.any())
    if blind:
        z = np.where(hidden, 1.0, z)
    lens = (np.exp(view[3]) / frame.radius) / z
    q = p[:2] * lens
    k1, k2 = distortion(rig, view[3], frame.size)
    r2 = q[0] * q[0] + q[1] * q[1]
    stretch = 1 + r2 * (k1 + k2 * r2)
    nx, ny = frame.normal
    along = nx * q[0] + ny * q[1]
    residual = along * stretch - frame.target
    bend = along * (2 * k1 + 4 * k2 * r2)
    by_q = frame.normal * stretch + bend * q
    by_log_f = by_q[0] * q[0] + by_q[1] * q[1]
    by_point = np.empty_like(p)
    by_point[:2] = by_q * lens
    by_point[2] = -by_log_f / z
    by_k1 = along * r2
    if blind:
        residual[hidden] = _FAR
        by_point[:, hidden] = 0.0
        by_log_f[hidden] = by_k1[hidden] = 0.0
    moment = np.empty_like(p)  # p × by_point
    moment[0] = p[1] * by_point[2] - p[2] * by_point[1]
    moment[1] = p[2] * by_point[0] - p[0] * by_point[2]
    moment[2] = p[0] * by_point[1] - p[1] * by_point[0]
    by_view = np.empty((VIEW_SIZE, p.shape[1]))
    by_view[:3] = turning(view).T @ moment
    by_view[3] = by_log_f + by_k1 * rig[K1_ZOOM]
    return Linear(residual, by_view, by_point, by_k1, r2, rotation)


def by_rig(frame: Frame, at: Linear, view: Array) -> Array:
    """Differentiate the residuals by the rig, shape (14, n)."""
    found = np.zeros((RIG_SIZE, len(frame.line)))
    by_ice = at.rotation.T @ at.by_point
    found[POSITION] = -by_ice
    found[K1] = at.by_k1
    found[K2] = at.by_k1 * at.r2
    found[K1_ZOOM] = at.by_k1 * zoom(view[3], frame.size)
    column = MEASURED[frame.line]
    unknown = np.flatnonzero(column >= 0)
    by_measure = by_ice[0] * frame.way[0] + by_ice[1] * frame.way[1]
    found[column[unknown], unknown] = by_measure[unknown]
    return found


def inverse(matrix: Array) -> Array:
    """Invert a symmetric positive definite matrix."""
    return np.asarray(np.linalg.inv(matrix), np.float64)


def _cost(r: Array, width: float) -> float:
    """Cauchy loss of residuals in standard deviations."""
    return float(0.5 * width**2 * np.log1p((r / width) ** 2).sum())


def _spread(r: Array, sd: Array, width: float) -> tuple[float, NDArray[np.bool_]]:
    """Root mean square of the inlying residuals, px, and which these are."""
    good = np.abs(r) < width
    px = (r * sd)[good]
    return float(np.sqrt(np.mean(px**2))) if len(px) else float("nan"), good


def solve_view(
    marks: Marks,
    view: View,
    rig: Array,
    size: tuple[int, int],
    *,
    view_sd: ArrayLike = VIEW_SD,
    offset: Array | float = 0.0,
    width: float = WIDTH,
    iterations: int = 12,
) -> ViewSolution:
    """Fit one frame's view to its marks, with the shared part held.

    Parameters
    ----------
    marks : Marks
    view : View
        Start, and the centre of the weak prior `view_sd`.
    rig : ndarray, shape (14,)
    size : tuple of int
        Width and height of the picture, px.
    view_sd : array_like, shape (4,)
        Standard deviation of the view about its start.
    offset : ndarray, shape (n,), optional
        How far the paint under each mark lies off its line, m.
    width : float
        Width of the Cauchy loss in standard deviations.
    """
    frame = Frame(marks, size, offset)
    points = frame.points(rig)
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = now = view.vector
    at = linearised(frame, points, now, rig)
    residual = at.residual
    cost, damping = _cost(residual, width), 1e-4
    for _ in range(iterations):
        step, ahead, new = _descent(at, now - start, hold, width, damping)
        if cost - new < _NEAR:
            if new < cost:
                now, residual, cost = now + step, ahead, new
            break
        tried = linearised(frame, points, now + step, rig)
        new = _cost(tried.residual, width) + 0.5 * float(hold @ (now + step - start) ** 2)
        if not new <= cost:
            damping *= 10
            continue
        now, at, residual, cost = now + step, tried, tried.residual, new
        damping = max(damping / 10, 1e-9)
    weighted = at.by_view / (1 + (residual / width) ** 2)
    normal = weighted @ at.by_view.T + np.diag(hold + 1e-9)
    return ViewSolution(View(now), inverse(normal), *_spread(residual, marks.sd, width), cost)


def _descent(
    at: Linear, away: Array, hold: Array, width: float, damping: float
) -> tuple[Array, Array, float]:
    """Step of a view, `away` from its start, to the least cost of linear residuals.

    Returns the step, and the residuals and the cost after it. Weights are worked out anew a few
    times: that costs a tenth of linearising anew.
    """
    step = np.zeros(VIEW_SIZE)
    residual = at.residual
    for _ in range(REWEIGHTINGS):
        weighted = at.by_view / (1 + (residual / width) ** 2)
        normal = weighted @ at.by_view.T
        normal.flat[:: VIEW_SIZE + 1] += hold + damping * normal.diagonal() + 1e-9
        step = -np.asarray(np.linalg.solve(normal, weighted @ at.residual + hold * away))
        residual = at.residual + step @ at.by_view
    cost = _cost(residual, width) + 0.5 * float(hold @ (away + step) ** 2)
    return step, residual, cost


def solve(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    *,
    prior: Prior | None = None,
    view_sd: ArrayLike = VIEW_SD,
    sharing: float = 1.0,
    width: float = WIDTH,
    iterations: int = 12,
) -> Solution:
    """Fit cameras to the marks of one or more frames.

    Parameters
    ----------
    frames : sequence of Marks
    views : sequence of View
        Start values, one per frame, and the centres of the weak prior `view_sd`.
    rig : ndarray, shape (14,)
        Shared part: start values if `prior` is given, else held as it is.
    size : tuple of int
        Width and height of the picture, px.
    prior : Prior, optional
        Makes the rig an unknown.
    view_sd : array_like, shape (4,)
        Standard deviation of each view about its start.
    sharing : float
        How many marks share one error (of paint, of the lens): so much less do they weigh
        against the rig's prior.
    width : float
        Width of the Cauchy loss in standard deviations.
    """
    if prior is None:
        found = [
            solve_view(m, v, rig, size, view_sd=view_sd, width=width, iterations=iterations)
            for m, v in zip(frames, views, strict=True)
        ]
        return Solution(
            rig,
            tuple(f.view for f in found),
            np.zeros((RIG_SIZE, RIG_SIZE)),
            np.array([f.rms for f in found]),
            tuple(f.inliers for f in found),
            sum(f.cost for f in found),
        )
    each = [Frame(m, size) for m in frames]
    held = sharing / prior.sd**2
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = [v.vector for v in views]

    def look(vs: Sequence[Array], s: Array) -> tuple[list[Linear], float]:
        seen = [linearised(f, f.points(s), v, s) for f, v in zip(each, vs, strict=True)]
        value = 0.5 * float((held * (s - prior.mean) ** 2).sum())
        for at, v, v0 in zip(seen, vs, start, strict=True):
            value += _cost(at.residual, width) + 0.5 * float(hold @ (v - v0) ** 2)
        return seen, value

    now, shared, damping = list(start), rig, 1e-4
    seen, cost = look(now, shared)
    schur = np.zeros((RIG_SIZE, RIG_SIZE))
    for _ in range(iterations):
        schur, right = np.diag(held), held * (shared - prior.mean)
        blocks = []
        for frame, at, v, v0 in zip(each, seen, now, start, strict=True):
            weight = 1 / (1 + (at.residual / width) ** 2)
            jv, js = at.by_view * weight, by_rig(frame, at, v)
            vv = jv @ at.by_view.T + np.diag(hold)
            vv.flat[:: VIEW_SIZE + 1] += damping * vv.diagonal() + 1e-9
            vs = jv @ js.T
            gv = jv @ at.residual + hold * (v - v0)
            eliminate = np.linalg.solve(vv, np.column_stack([vs, gv]))
            schur += (js * weight) @ js.T - vs.T @ eliminate[:, :-1]
            right += js @ (weight * at.residual) - vs.T @ eliminate[:, -1]
            blocks.append(eliminate)
        step = -np.linalg.solve(schur, right)
        tried = [v - b[:, -1] - b[:, :-1] @ step for v, b in zip(now, blocks, strict=True)]
        ahead, new = look(tried, shared + step)
        if not new <= cost:
            damping *= 10
            if damping > 1e4:
                break
            continue
        done = cost - new < _DONE * (1 + cost)
        now, shared, seen, cost = tried, shared + step, ahead, new
        damping = max(damping / 10, 1e-9)
        if done:
            break
    spread = [_spread(at.residual, f.sd, width) for at, f in zip(seen, each, strict=True)]
    return Solution(
        shared,
        tuple(View(v) for v in now),
        sharing * inverse(schur),
        np.array([rms for rms, _ in spread]),
        tuple(good for _, good in spread),
        float(cost),
    )
