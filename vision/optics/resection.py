"""Resection: a frame's view from its marks, with what frames share held, robustly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.vision.optics.linear import Linear, Observations, linearised, view_equations
from curlshot.vision.optics.paint import Marks
from curlshot.vision.optics.pose import VIEW_SIZE, View
from curlshot.vision.optics.robust import WIDTH, inverse, loss, spread

Array = NDArray[np.float64]

VIEW_SD = (np.inf, np.inf, 0.15, np.inf)
"""How far a view may lie from its start: the roll is free where no line is seen."""

ROUND = (np.inf, np.inf, 0.01, np.inf)
"""The same where circles alone are fitted, rad: they do not tell how it is rolled, and marks that
slide along them leave the line in which they were measured."""

_NEAR = 0.5
"""A step that lowers the cost by less is the last one."""

_STRAIGHT = 0.001
"""Over such a turn (rad) or change of log focal length residuals are straight to 0.003 px."""

REWEIGHTINGS = 4
"""Most rounds of weights for one linearisation of a view."""

_FINE = 1e-5
"""A change of a view, rad, with which weights hardly change: 0.02 px."""

_DIAGONAL = np.arange(VIEW_SIZE)


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


def solve_view(
    marks: Marks,
    view: View,
    rig: Array,
    size: tuple[int, int],
    *,
    view_sd: ArrayLike = VIEW_SD,
    width: float = WIDTH,
    iterations: int = 12,
) -> ViewSolution:
    """Fit one frame's view to its marks, with the shared part held.

    Parameters
    ----------
    marks : Marks
    view : View
        Start, and the centre of the weak prior `view_sd`.
    rig : ndarray, shape (15,)
    size : tuple of int
        Width and height of the picture, px.
    view_sd : array_like, shape (4,)
        Standard deviation of the view about its start.
    width : float
        Width of the Cauchy loss in standard deviations.
    iterations : int
        Steps at most.
    """
    observed = Observations(marks, size)
    (found,) = solve_views(
        observed, [view], rig, view_sd=view_sd, width=width, iterations=iterations
    )
    return found


def solve_views(
    observed: Observations,
    views: Sequence[View],
    rig: Array,
    *,
    view_sd: ArrayLike = VIEW_SD,
    width: float = WIDTH,
    iterations: int = 12,
) -> list[ViewSolution]:
    """Fit the views of several frames at once, each by itself; as `solve_view`."""
    points = observed.points(rig)
    hold = 1 / np.asarray(view_sd, float) ** 2
    start = now = np.array([view.vector for view in views])
    at = linearised(observed, points, now, rig)
    residual = at.residual
    cost = observed.summed(loss(residual, width))
    damping = np.full(len(now), 1e-4)
    for _ in range(iterations):
        step, ahead, new = _descent(observed, at, now - start, hold, width, damping)
        if ((cost - new < _NEAR) | (np.abs(step).max(1) < _STRAIGHT)).all():
            better = new < cost
            now, cost = np.where(better[:, None], now + step, now), np.where(better, new, cost)
            residual = np.where(observed.each(better), ahead, residual)
            break
        tried = linearised(observed, points, now + step, rig)
        new = observed.summed(loss(tried.residual, width))
        new += 0.5 * (now + step - start) ** 2 @ hold
        better = new <= cost
        now, cost = np.where(better[:, None], now + step, now), np.where(better, new, cost)
        damping = np.where(better, np.maximum(damping / 10, 1e-9), 10 * damping)
        at = tried if better.all() else linearised(observed, points, now, rig)
        residual = at.residual
    information, _ = view_equations(observed, at, 1 / (1 + (residual / width) ** 2))
    information[:, _DIAGONAL, _DIAGONAL] += hold + 1e-9
    found = []
    for k, part in enumerate(observed.parts):
        rms, inliers = spread(residual[part], observed.sd[part], width)
        found.append(ViewSolution(View(now[k]), information[k], rms, inliers, float(cost[k])))
    return found


def _descent(
    observed: Observations, at: Linear, away: Array, hold: Array, width: float, damping: Array
) -> tuple[Array, Array, Array]:
    """Step views, `away` from their starts, to the least costs of linear residuals.

    Returns the steps, and the residuals and the costs after them. Weights are worked out anew a
    few times: that costs a tenth of linearising anew.
    """
    step, residual, scale = np.zeros_like(away), at.residual, 1 / width
    for _ in range(REWEIGHTINGS):
        last, relative = step, scale * residual
        normal, right = view_equations(observed, at, 1 / (1 + relative * relative))
        right += hold * away
        normal[:, _DIAGONAL, _DIAGONAL] *= 1 + damping[:, None]
        normal[:, _DIAGONAL, _DIAGONAL] += hold + 1e-9
        step = -np.asarray(np.linalg.solve(normal, right[..., None]))[..., 0]
        residual = at.residual + observed.product(step, at.by_view)
        if np.abs(step - last).max() < _FINE:
            break
    cost = observed.summed(loss(residual, width)) + 0.5 * (away + step) ** 2 @ hold
    return step, residual, cost
