"""Residuals of marks by a camera's view and rig, and their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import MEASURED, Marks, ice_frame, measures
from curlshot.vision.optics.pose import VIEW_SIZE, rotation_matrix, turning
from curlshot.vision.optics.rig import K1, K1_BEND, K1_ZOOM, K2, POSITION, RIG_SIZE, zoom

Array = NDArray[np.float64]
Value = TypeVar("Value", np.float64, np.bool_)

_FAR = 1e6
"""Residual, in standard deviations, of a point that the camera cannot see."""


class Observations:
    """Marks of one frame, or of several, in the form in which residuals are worked out.

    One column per mark; the frames follow each other, `counts` marks of each.
    """

    def __init__(
        self,
        marks: Marks,
        size: tuple[int, int],
        offset: Array | float = 0.0,
        counts: Sequence[int] | None = None,
    ) -> None:
        self.size = size
        self.radius = float(np.hypot(*size)) / 2
        self.sd = marks.sd
        self.line = marks.line
        self.counts = [len(marks)] if counts is None else list(counts)
        ends = np.cumsum(self.counts).tolist()
        self.parts = [slice(end - n, end) for end, n in zip(ends, self.counts, strict=True)]
        foot, self.way = ice_frame(marks.line, marks.along, marks.across)
        self.foot = np.zeros((3, len(marks)))
        self.foot[:2] = foot + self.way * offset
        normal = marks.normal.T / marks.sd
        x, y = marks.pixel.T
        self.target = (x - (size[0] - 1) / 2) * normal[0] + (y - (size[1] - 1) / 2) * normal[1]
        self.normal = normal * self.radius

    def points(self, rig: Array) -> Array:
        """Places of the marks relative to the camera, along the ice's axes, shape (3, n), m."""
        away = self.foot - rig[POSITION, None]
        away[:2] += self.way * measures(rig)[self.line]
        return away

    def each(self, values: NDArray[Value]) -> NDArray[Value]:
        """Give every mark its frame's value, (..., frames) to (..., n); alone, it is broadcast."""
        return values if len(self.parts) == 1 else np.repeat(values, self.counts, axis=-1)

    def product(self, steps: Array, by_view: Array) -> Array:
        """Change of each mark's residual, (n,), with its frame's step of the view, (frames, 4)."""
        if len(self.parts) == 1:
            return np.asarray(steps[0] @ by_view)
        return np.asarray((self.each(steps.T) * by_view).sum(0))

    def summed(self, values: Array) -> Array:
        """Sum up each frame's marks, (n,) to (frames,)."""
        if len(self.parts) == 1:
            return np.asarray(values.sum(keepdims=True))
        number = np.repeat(np.arange(len(self.parts)), self.counts)
        return np.bincount(number, values, len(self.parts)).astype(np.float64)

    def turned(self, matrices: Sequence[Array], columns: Array) -> Array:
        """Multiply the columns of every frame, (3, n), by its matrix, (3, 3)."""
        if len(matrices) == 1:
            return np.asarray(matrices[0] @ columns)
        found = np.empty_like(columns)
        for matrix, part in zip(matrices, self.parts, strict=True):
            found[:, part] = matrix @ columns[:, part]
        return found


@dataclass(frozen=True)
class Linear:
    """Residuals along the normals, in standard deviations, and what they follow from.

    Attributes
    ----------
    residual : ndarray, shape (n,)
    by_view : ndarray, shape (4, n)
        Derivatives by the view of the mark's frame.
    by_place : ndarray, shape (3, n)
        Derivatives by the place on the ice, along the ice's axes.
    by_k1 : ndarray, shape (n,)
        Derivative by k1; `r2` times that is the one by k2.
    r2 : ndarray, shape (n,)
        |q|² of the undistorted point.
    """

    residual: Array
    by_view: Array
    by_place: Array
    by_k1: Array
    r2: Array


def linearised(observed: Observations, points: Array, views: Array, rig: Array) -> Linear:
    """Residuals of marks at `points` (see `Observations.points`), and derivatives.

    Parameters
    ----------
    observed : Observations
    points : ndarray, shape (3, n)
        Places of the marks relative to the camera, m.
    views : ndarray, shape (4,) or (frames, 4)
    rig : ndarray, shape (15,)
    """
    views = views.reshape(-1, VIEW_SIZE)
    rotations = [rotation_matrix(view) for view in views]
    p = observed.turned(rotations, points)
    z = p[2]
    hidden = z <= 1e-3
    blind = bool(hidden.any())
    if blind:
        z = np.where(hidden, 1.0, z)
    lens = observed.each(np.exp(views[:, 3]) / observed.radius) / z
    q = p[:2] * lens
    zoomed = zoom(views[:, 3], observed.size)
    k1 = observed.each(rig[K1] + zoomed * (rig[K1_ZOOM] + zoomed * rig[K1_BEND]))
    k2 = rig[K2]
    r2 = q[0] * q[0] + q[1] * q[1]
    stretch = 1 + r2 * (k1 + k2 * r2)
    nx, ny = observed.normal
    along = nx * q[0] + ny * q[1]
    residual = along * stretch - observed.target
    bend = along * (2 * k1 + 4 * k2 * r2)
    by_q = observed.normal * stretch + bend * q
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
    by_view[:3] = observed.turned([turning(view).T for view in views], moment)
    by_view[3] = by_log_f + by_k1 * observed.each(rig[K1_ZOOM] + 2 * zoomed * rig[K1_BEND])
    by_place = observed.turned([rotation.T for rotation in rotations], by_point)
    return Linear(residual, by_view, by_place, by_k1, r2)


def view_equations(observed: Observations, at: Linear, weight: Array) -> tuple[Array, Array]:
    """Give the normal equations of each frame's view, shapes (frames, 4, 4) and (frames, 4)."""
    own = at.by_view * weight
    matrices = [own[:, part] @ at.by_view[:, part].T for part in observed.parts]
    return np.array(matrices), np.array(
        [own[:, part] @ at.residual[part] for part in observed.parts]
    )


def by_rig(observed: Observations, at: Linear, views: Array) -> Array:
    """Differentiate the residuals by the rig, shape (15, n)."""
    found = np.zeros((RIG_SIZE, len(observed.line)))
    found[POSITION] = -at.by_place
    found[K1] = at.by_k1
    found[K2] = at.by_k1 * at.r2
    zoomed = observed.each(zoom(views.reshape(-1, VIEW_SIZE)[:, 3], observed.size))
    found[K1_ZOOM] = at.by_k1 * zoomed
    found[K1_BEND] = at.by_k1 * zoomed**2
    column = MEASURED[observed.line]
    unknown = np.flatnonzero(column >= 0)
    found[column[unknown], unknown] = by_measure(observed, at)[unknown]
    return found


def by_measure(observed: Observations, at: Linear) -> Array:
    """Differentiate the residuals by the measure of the mark's own line, shape (n,)."""
    return np.asarray(at.by_place[0] * observed.way[0] + at.by_place[1] * observed.way[1])
