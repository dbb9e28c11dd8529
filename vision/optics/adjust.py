"""Cameras of a few frames by robust least squares: their views, and what the frames share.

Each frame's view is eliminated (Schur complement), so that the cost grows only linearly with the
number of frames. Triggs et al., 2000, Bundle adjustment: a modern synthesis, LNCS 1883, section 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.vision.optics.linear import Linear, Observations, by_rig, linearised
from curlshot.vision.optics.paint import Marks, joined
from curlshot.vision.optics.pose import VIEW_SIZE, View
from curlshot.vision.optics.resection import VIEW_SD
from curlshot.vision.optics.rig import Prior
from curlshot.vision.optics.robust import WIDTH, loss, spread

Array = NDArray[np.float64]

SHARING = 20.0
"""Edge points of one frame that share an error of the paint, about 30° of a circle."""

_DONE = 1e-4
"""Relative fall of the cost below which a fit has converged."""


@dataclass(frozen=True)
class Solution:
    """Result of `solve`.

    Attributes
    ----------
    rig : ndarray, shape (15,)
        Shared part, in the order of `curlshot.vision.optics.rig.Prior`.
    views : tuple of View
        One per frame.
    rms : ndarray
        Residual of the inlying marks per frame, px; NaN where there are none.
    inliers : tuple of ndarray of bool
        Marks within reach of the model, per frame.
    cost : float
        Half the robust sum of squares, the priors' part included.
    """

    rig: Array
    views: tuple[View, ...]
    rms: Array
    inliers: tuple[NDArray[np.bool_], ...]
    cost: float


def solve(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    *,
    prior: Prior,
    sharing: float = SHARING,
    view_sd: ArrayLike = VIEW_SD,
    iterations: int = 12,
) -> Solution:
    """Fit cameras to the marks of one or more frames.

    Parameters
    ----------
    frames : sequence of Marks
    views : sequence of View
        Start values, one per frame, and the centres of the weak prior `view_sd`.
    rig : ndarray, shape (15,)
        Start values of the shared part.
    size : tuple of int
        Width and height of the picture, px.
    prior : Prior
        Of the shared part.
    sharing : float
        How many marks share one error (of paint, of the lens): so much less do they weigh
        against the rig's prior.
    view_sd : array_like, shape (4,)
        Of that prior.
    iterations : int
        Steps at most.
    """
    observed = Observations(joined(frames), size, counts=[len(m) for m in frames])
    held = sharing / prior.sd**2
    hold = 1 / np.square(view_sd)
    start = np.array([v.vector for v in views])

    def look(vs: Array, s: Array) -> tuple[Linear, float]:
        at = linearised(observed, observed.points(s), vs, s)
        value = float((held * (s - prior.mean) ** 2).sum() + (hold * (vs - start) ** 2).sum())
        return at, 0.5 * value + float(loss(at.residual, WIDTH).sum())

    now, shared, damping = start, rig, 1e-4
    at, cost = look(now, shared)
    for _ in range(iterations):
        weight = 1 / (1 + (at.residual / WIDTH) ** 2)
        jv, js = at.by_view * weight, by_rig(observed, at, now)
        schur = np.diag(held) + (js * weight) @ js.T
        right = held * (shared - prior.mean) + js @ (weight * at.residual)
        blocks = []
        for part, v, v0 in zip(observed.parts, now, start, strict=True):
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
    left = [spread(at.residual[part], observed.sd[part], WIDTH) for part in observed.parts]
    return Solution(
        shared,
        tuple(View(v) for v in now),
        np.array([rms for rms, _ in left]),
        tuple(good for _, good in left),
        float(cost),
    )
