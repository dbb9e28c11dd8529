"""Cameras from marks, by robust least squares over one frame or many.

What a clip shares and what each frame has for itself are solved together; the frames are
eliminated one by one (Schur complement), so that the cost grows only linearly with their number.
Triggs et al., 2000, Bundle adjustment: a modern synthesis, LNCS 1883, section 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from vision.pose import (
    CENTRE_LINE,
    CENTRE_X,
    DOWN,
    EIGHT,
    FOUR,
    K1,
    K1_ZOOM,
    K2,
    LEFT,
    POSITION,
    R4,
    R8,
    RIG_SIZE,
    RIGHT,
    SIDE_L,
    SIDE_R,
    TEE_LINE,
    TEE_Y,
    VIEW_SIZE,
    Marks,
    Prior,
    View,
    distortion,
    ice_frame,
    measures,
    zoom,
)

Array = NDArray[np.float64]

_FAR = 1e6
"""Residual, in standard deviations, of a point that the camera cannot see."""


_MEASURED = (
    (EIGHT, R8), (FOUR, R4), (CENTRE_LINE, CENTRE_X), (TEE_LINE, TEE_Y), (LEFT, SIDE_L),
    (RIGHT, SIDE_R),
)  # fmt: skip
"""Kinds of mark whose measure is an unknown of the rig."""


@dataclass(frozen=True)
class Solution:
    """Result of `solve`.

    Attributes
    ----------
    rig : ndarray, shape (12,)
        Shared part, in the order of `vision.pose.Prior`.
    views : tuple of View
        One per frame.
    rig_cov : ndarray, shape (12, 12)
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
class _Design:
    """What stays the same of a frame's marks while the camera moves."""

    marks: Marks
    foot: Array
    way: Array


def solve(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    *,
    prior: Prior | None = None,
    view_sd: ArrayLike = (np.inf, np.inf, 0.15, np.inf),
    sharing: float = 1.0,
    width: float = 3.0,
    iterations: int = 12,
) -> Solution:
    """Fit cameras to the marks of one or more frames.

    Parameters
    ----------
    frames : sequence of Marks
    views : sequence of View
        Start values, one per frame, and the centres of the weak prior `view_sd`.
    rig : ndarray, shape (12,)
        Shared part: start values if `prior` is given, else held as it is.
    size : tuple of int
        Width and height of the picture, px.
    prior : Prior, optional
        Makes the rig an unknown.
    view_sd : array_like, shape (4,)
        Standard deviation of each view about its start (the roll is free where no line is seen).
    sharing : float
        How many marks share one error (of paint, of the lens): so much less do they weigh
        against the rig's prior.
    width : float
        Width of the Cauchy loss in standard deviations.
    """
    designs = [_Design(m, *ice_frame(m.line, m.along)) for m in frames]
    held = np.zeros(0) if prior is None else sharing / prior.sd**2
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = [v.vector for v in views]
    now, shared = list(start), rig
    count = RIG_SIZE if prior is not None else 0

    def total(vs: Sequence[Array], s: Array) -> float:
        value = 0.0 if prior is None else 0.5 * float((held * (s - prior.mean) ** 2).sum())
        for design, v, v0 in zip(designs, vs, start, strict=True):
            value += _cost(_residuals(design, v, s, size), width)
            value += 0.5 * float(hold @ (v - v0) ** 2)
        return value

    cost, damping = total(now, shared), 1e-4
    schur = np.zeros((count, count))
    for _ in range(iterations):
        schur, right = np.zeros((count, count)), np.zeros(count)
        if prior is not None:
            schur += np.diag(held)
            right += held * (shared - prior.mean)
        blocks = []
        for design, v, v0 in zip(designs, now, start, strict=True):
            r, jv, js = _linearised(design, v, shared, size, count > 0)
            weight = (1 / (1 + (r / width) ** 2))[:, None]
            vv = (jv * weight).T @ jv + np.diag(hold)
            vv += np.diag(damping * np.diag(vv) + 1e-9)
            vs = (jv * weight).T @ js
            gv = (jv * weight).T @ r + hold * (v - v0)
            eliminate = np.linalg.solve(vv, np.column_stack([vs, gv]))
            schur += (js * weight).T @ js - vs.T @ eliminate[:, :-1]
            right += (js * weight).T @ r - vs.T @ eliminate[:, -1]
            blocks.append(eliminate)
        step = -np.linalg.solve(schur, right) if count else np.zeros(0)
        moved = shared + step if count else shared
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
    rms, inliers = [], []
    for design, v in zip(designs, now, strict=True):
        r = _residuals(design, v, shared, size)
        good = np.abs(r) < width
        inliers.append(good)
        px = (r * design.marks.sd)[good]
        rms.append(float(np.sqrt(np.mean(px**2))) if len(px) else float("nan"))
    cov = np.zeros((RIG_SIZE, RIG_SIZE))
    if count:
        cov[:] = sharing * np.linalg.inv(schur)
    return Solution(
        shared, tuple(View(v) for v in now), cov, np.array(rms), tuple(inliers), float(cost)
    )


def _cost(r: Array, width: float) -> float:
    """Cauchy loss of residuals in standard deviations."""
    return float(0.5 * width**2 * np.log1p((r / width) ** 2).sum())


def _residuals(design: _Design, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    return _linearised(design, view, rig, size, None)[0]


def _linearised(
    design: _Design, view: Array, rig: Array, size: tuple[int, int], by_rig: bool | None
) -> tuple[Array, Array, Array]:
    """Residuals along the normals, in sd's, and their derivatives by the view and by the rig.

    `by_rig` None leaves out both derivatives, False the second.
    """
    marks = design.marks
    none = np.zeros((len(marks), 0))
    ice = design.foot + design.way * measures(rig)[marks.line][:, None]
    turn, by_vector = cv2.Rodrigues(view[:3])
    rotation = np.asarray(turn) @ DOWN
    p = ice @ rotation[:, :2].T - rotation @ rig[POSITION]
    seen = p[:, 2] > 1e-3
    z = np.where(seen, p[:, 2], 1.0)
    diagonal = float(np.hypot(*size)) / 2
    lens = np.exp(view[3]) / diagonal / z
    qx, qy = p[:, 0] * lens, p[:, 1] * lens
    k1, k2 = distortion(rig, view[3], size)
    r2 = qx**2 + qy**2
    stretch = 1 + r2 * (k1 + k2 * r2)
    nx, ny = (marks.normal * (diagonal / marks.sd)[:, None]).T
    off = marks.pixel - [(size[0] - 1) / 2, (size[1] - 1) / 2]
    along = nx * qx + ny * qy
    r = along * stretch - (marks.normal * off).sum(-1) / marks.sd
    r = np.where(seen, r, _FAR)
    if by_rig is None:
        return r, none, none
    # Chain: residual by q, by the point in camera axes, by rotation, place and measures.
    bend = along * (2 * k1 + 4 * k2 * r2)
    by_qx, by_qy = nx * stretch + bend * qx, ny * stretch + bend * qy
    by_log_f = by_qx * qx + by_qy * qy
    by_p = np.stack([by_qx * lens, by_qy * lens, -by_log_f / z], axis=-1) * seen[:, None]
    away = np.column_stack([ice, np.zeros(len(ice))]) - rig[POSITION]
    jv = np.empty((len(marks), VIEW_SIZE))
    for i, derivative in enumerate(np.asarray(by_vector).reshape(3, 3, 3)):
        jv[:, i] = (by_p * (away @ (derivative @ DOWN).T)).sum(-1)
    by_k1 = along * r2 * seen
    jv[:, 3] = by_log_f * seen + by_k1 * rig[K1_ZOOM]
    if not by_rig:
        return r, jv, none
    js = np.zeros((len(marks), RIG_SIZE))
    js[:, POSITION] = -by_p @ rotation
    js[:, K1], js[:, K2] = by_k1, by_k1 * r2
    js[:, K1_ZOOM] = by_k1 * zoom(view[3], size)
    by_measure = (by_p @ rotation[:, :2] * design.way).sum(-1)
    for kind, column in _MEASURED:
        js[:, column] = np.where(marks.line == kind, by_measure, 0.0)
    return r, jv, js
