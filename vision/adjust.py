"""Cameras from marks, by robust least squares.

One frame's view with the shared part held (`solve_view`), or both together (`solve`): then the
frames are eliminated one by one (Schur complement), so that the cost grows only linearly with
their number. Triggs et al., 2000, Bundle adjustment: a modern synthesis, LNCS 1883, section 6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vision.linear import Frame, Linear, by_rig, linearised
from vision.paint import Marks, joined
from vision.pose import VIEW_SIZE, View
from vision.rig import RIG_SIZE, Prior

Array = NDArray[np.float64]

VIEW_SD = (np.inf, np.inf, 0.15, np.inf)
"""How far a view may lie from its start: the roll is free where no line is seen."""

WIDTH = 3.0
"""Width of the Cauchy loss, in standard deviations."""

_NEAR = 0.5
"""A step that lowers the cost by less is the last one."""

_STRAIGHT = 0.001
"""Over such a turn (rad) or change of log focal length residuals are straight to 0.003 px."""

REWEIGHTINGS = 4
"""Most rounds of weights for one linearisation of a view."""

_FINE = 1e-5
"""A change of a view, rad, with which weights hardly change: 0.02 px."""

_DIAGONAL = np.arange(VIEW_SIZE)

_DONE = 1e-4
"""Relative fall of the cost below which a fit has converged."""


@dataclass(frozen=True)
class Solution:
    """Result of `solve`.

    Attributes
    ----------
    rig : ndarray, shape (14,)
        Shared part, in the order of `vision.rig.Prior`.
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
    information : ndarray, shape (4, 4)
        Inverse covariance of the view, the shared part taken as known and the marks as
        independent.
    rms : float
        Residual of the inlying marks, px; NaN where there are none.
    inliers : ndarray of bool, shape (n,)
        Marks within reach of the model.
    cost : float
        Half the robust sum of squares.
    """

    view: View
    information: Array
    rms: float
    inliers: NDArray[np.bool_]
    cost: float

    @property
    def cov(self) -> Array:
        """Covariance of the view, shape (4, 4)."""
        return inverse(self.information)


def inverse(matrix: Array) -> Array:
    """Invert a symmetric positive definite matrix."""
    return np.asarray(np.linalg.inv(matrix), np.float64)


def _loss(r: Array, width: float) -> Array:
    """Cauchy loss of each residual in standard deviations."""
    relative = (1 / width) * r
    return 0.5 * width**2 * np.log1p(relative * relative)


def _spread(r: Array, sd: Array, width: float) -> tuple[float, NDArray[np.bool_]]:
    """Root mean square of the inlying residuals, px, and which these are."""
    good = np.abs(r) < width
    px = (r * sd)[good]
    return math.sqrt(px @ px / len(px)) if len(px) else math.nan, good


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
    return solve_views(frame, [view], rig, view_sd=view_sd, width=width, iterations=iterations)[0]


def solve_views(
    frame: Frame,
    views: Sequence[View],
    rig: Array,
    *,
    view_sd: ArrayLike = VIEW_SD,
    width: float = WIDTH,
    iterations: int = 12,
) -> list[ViewSolution]:
    """Fit the views of several frames at once, each by itself; as `solve_view`."""
    points = frame.points(rig)
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = now = np.array([view.vector for view in views])
    at = linearised(frame, points, now, rig)
    residual = at.residual
    cost = frame.summed(_loss(residual, width))
    damping = np.full(len(now), 1e-4)
    for _ in range(iterations):
        step, ahead, new = _descent(frame, at, now - start, hold, width, damping)
        if ((cost - new < _NEAR) | (np.abs(step).max(1) < _STRAIGHT)).all():
            better = new < cost
            now, cost = np.where(better[:, None], now + step, now), np.where(better, new, cost)
            residual = np.where(frame.each(better), ahead, residual)
            break
        tried = linearised(frame, points, now + step, rig)
        new = frame.summed(_loss(tried.residual, width))
        new += 0.5 * (now + step - start) ** 2 @ hold
        better = new <= cost
        now, cost = np.where(better[:, None], now + step, now), np.where(better, new, cost)
        damping = np.where(better, np.maximum(damping / 10, 1e-9), 10 * damping)
        at = tried if better.all() else linearised(frame, points, now, rig)
        residual = at.residual
    weighted = at.by_view / (1 + (residual / width) ** 2)
    found = []
    for k, part in enumerate(frame.parts):
        information = weighted[:, part] @ at.by_view[:, part].T
        information[_DIAGONAL, _DIAGONAL] += hold + 1e-9
        rms, inliers = _spread(residual[part], frame.sd[part], width)
        found.append(ViewSolution(View(now[k]), information, rms, inliers, float(cost[k])))
    return found


def _descent(
    frame: Frame, at: Linear, away: Array, hold: Array, width: float, damping: Array
) -> tuple[Array, Array, Array]:
    """Step views, `away` from their starts, to the least costs of linear residuals.

    Returns the steps, and the residuals and the costs after them. Weights are worked out anew a
    few times: that costs a tenth of linearising anew.
    """
    step, residual, scale = np.zeros_like(away), at.residual, 1 / width
    for _ in range(REWEIGHTINGS):
        last, relative = step, scale * residual
        weighted = at.by_view / (1 + relative * relative)
        normal = np.array([weighted[:, p] @ at.by_view[:, p].T for p in frame.parts])
        right = np.array([weighted[:, p] @ at.residual[p] for p in frame.parts]) + hold * away
        normal[:, _DIAGONAL, _DIAGONAL] *= 1 + damping[:, None]
        normal[:, _DIAGONAL, _DIAGONAL] += hold + 1e-9
        step = -np.asarray(np.linalg.solve(normal, right[..., None]))[..., 0]
        residual = at.residual + frame.product(step, at.by_view)
        if np.abs(step - last).max() < _FINE:
            break
    cost = frame.summed(_loss(residual, width)) + 0.5 * (away + step) ** 2 @ hold
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
    every = Frame(joined(frames), size, counts=[len(m) for m in frames])
    held = sharing / prior.sd**2
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = np.array([v.vector for v in views])

    def look(vs: Array, s: Array) -> tuple[Linear, float]:
        at = linearised(every, every.points(s), vs, s)
        value = float((held * (s - prior.mean) ** 2).sum() + (hold * (vs - start) ** 2).sum())
        return at, 0.5 * value + float(_loss(at.residual, width).sum())

    now, shared, damping = start, rig, 1e-4
    at, cost = look(now, shared)
    schur = np.zeros((RIG_SIZE, RIG_SIZE))
    for _ in range(iterations):
        weight = 1 / (1 + (at.residual / width) ** 2)
        jv, js = at.by_view * weight, by_rig(every, at, now)
        schur = np.diag(held) + (js * weight) @ js.T
        right = held * (shared - prior.mean) + js @ (weight * at.residual)
        blocks = []
        for part, v, v0 in zip(every.parts, now, start, strict=True):
            vv = jv[:, part] @ at.by_view[:, part].T + np.diag(hold)
            vv.flat[:: VIEW_SIZE + 1] += damping * vv.diagonal() + 1e-9
            vs = jv[:, part] @ js[:, part].T
            gv = jv[:, part] @ at.residual[part] + hold * (v - v0)
            eliminate = np.linalg.solve(vv, np.column_stack([vs, gv]))
            schur -= vs.T @ eliminate[:, :-1]
            right -= vs.T @ eliminate[:, -1]
            blocks.append(eliminate)
        step = -np.linalg.solve(schur, right)
        tried = now - np.array([b[:, -1] + b[:, :-1] @ step for b in blocks])
        ahead, new = look(tried, shared + step)
        if not new <= cost:
            damping *= 10
            if damping > 1e4:
                break
            continue
        done = cost - new < _DONE * (1 + cost)
        now, shared, at, cost = tried, shared + step, ahead, new
        damping = max(damping / 10, 1e-9)
        if done:
            break
    spread = [_spread(at.residual[part], every.sd[part], width) for part in every.parts]
    return Solution(
        shared,
        tuple(View(v) for v in now),
        sharing * inverse(schur),
        np.array([rms for rms, _ in spread]),
        tuple(good for _, good in spread),
        float(cost),
    )
