"""Bundle adjustment: camera place, lens, paint and views fitted to many frames of a clip at once.

The unknowns are the rig (place, lens, painted measures), each frame's view, and the paint: how
far each piece of a painted line lies off its nominal course, some by much: a stone beside a line
draws it aside. A camera stays where it is unless the marks fit much better if it moves slowly:
then along a curve of the third degree in time.

Edge points of one piece, in however many frames, share that error: so it, not the number of
points, limits what can be known. How large such errors are, and the noise of single points, is
learned from the residuals themselves by expectation and maximisation: Dempster, Laird and Rubin,
1977, Journal of the Royal Statistical Society B 39, 1. Bundle adjustment: Triggs et al., 2000,
LNCS 1883.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.arrow import Arrow
from curlshot.vision.optics.linear import (
    Linear,
    Observations,
    by_measure,
    by_rig,
    linearised,
    view_equations,
)
from curlshot.vision.optics.paint import Marks, joined
from curlshot.vision.optics.pose import VIEW_SIZE, View
from curlshot.vision.optics.resection import VIEW_SD
from curlshot.vision.optics.rig import POSITION, RIG_SIZE, Prior
from curlshot.vision.optics.robust import WIDTH, loss
from curlshot.vision.optics.shared import BINS, Bundle, family, piece_of, polynomials

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FAMILIES = 3
"""Of marks: see `curlshot.vision.optics.shared.family`."""

PAINT_SD = np.array([0.001, 0.002, 1.0])
"""What is expected of the paint of circles and of lines, m; fixed points have none."""

PAINT_TRUST = 3.0
"""Pieces of paint that this expectation is worth."""

NOISE_TRUST = 10.0
"""Marks that their stated standard deviation is worth against their residuals."""

LOST = 0.85
"""Expected w r² of a normal residual over the expected w, Cauchy weights of width 3."""

TRAVEL_SD = 0.3
"""How far a camera that moves goes, m."""

MOVES = 100.0
"""By how much the log likelihood must rise for a camera that moves: as marks share more errors
than those of the paint, it rises by up to 35 for one that does not."""

DEGREE = 3
"""Of the polynomial of time along which a camera moves."""

AXIS_SD = 0.25
"""How far from its middle a lens's axis may be in a picture that was cropped, half diagonals."""

ASIDE = (0.05, 50.0), (0.1, 20.0)
"""From where on it is not in the middle, half diagonals, if the log likelihood rises by so much
then. In 220 clips that were not cropped it rose by up to 30, with an axis up to 0.1 aside; cropped
so that the axis was 0.06 aside, by 110 in the median."""

CROOKED = 0.005
"""How ragged no sheet's lines are, m: of some 140 clips by 0.4 to 3.6 mm. In a cropped picture
straight ones seem to be, for they do not fit the circles."""

PIXELATED = 0.5
"""The same in pixels: of a line that is far away or in a small picture no more is made out."""

HIGHEST = 20.0
"""From what height on a picture is rather stretched, and so looks tilted, than taken from there, m:
broadcast cameras hang at 6 to 11."""

LEAST_FRAMES = 6
"""Fewer frames tell nothing of a camera's motion."""

BLIND = 1e-9
"""What holds a view that sees none of its marks."""

ROUNDS = 4
"""Estimates of paint and noise, each followed by a fit."""

FIRST, NEXT, LAST = 30, 1, 4
"""Most steps of the first fit, of each after such an estimate, and of the last. Begun far off, the
first must get to where it ends: else the paint is learned to be as ragged as the camera is wrong,
and keeps it there."""

SETTLED = 0.03
"""Rise of the log likelihood by less than which a step ends a fit: a quarter of a standard
error."""


def bundle(
    frames: Sequence[Marks],
    times: Sequence[float],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    prior: Prior,
) -> tuple[Bundle, tuple[View, ...]]:
    """Fit what frames share, and their views.

    Parameters
    ----------
    frames : sequence of Marks
        Not empty.
    times : sequence of float
        Of the frames, s, ascending.
    views : sequence of View
        Start values, one per frame, and the centres of a weak prior (`VIEW_SD`).
    rig : ndarray, shape (15,)
        Start values of the shared part.
    size : tuple of int
        Width and height of the picture, px.
    prior : Prior
    """
    span = times[0], times[-1]
    still = _Problem(frames, polynomials(np.array(times), span, 0), views, size, prior)
    start = np.array([v.vector for v in views])
    state = _State(rig, np.zeros((0, 3)), np.zeros(len(still.pieces)), start)
    problem, found = still, still.learn(state, PAINT_SD, np.ones(FAMILIES))
    if len(frames) >= LEAST_FRAMES:
        moving = _Problem(frames, polynomials(np.array(times), span, DEGREE), views, size, prior)
        state, _, paint, noise = found
        state = replace(state, travel=np.zeros((DEGREE, 3)))
        if moving.gain(state, paint, noise) > MOVES:
            problem, found = moving, moving.learn(state, paint, noise)
    state, cov, paint, noise = found
    cropped = _is_cropped(problem, state, paint, noise)
    offsets = np.arange(problem.shared + state.views.size, len(cov))
    known = np.concatenate([np.arange(problem.shared), offsets])
    cov = cov[np.ix_(known, known)]
    views = tuple(View(v) for v in state.views)
    return Bundle(
        state.rig, state.travel, span, problem.pieces, state.offset, cov, noise, cropped,
        float(paint[0]),
    ), views  # fmt: skip


def _is_cropped(problem: _Problem, state: _State, paint: Array, noise: Array) -> bool:
    """Whether pictures seem to be cropped off their middle, or stretched, where a fit ended."""
    # Where it bends straight lines, their paint was learned to be as ragged as that.
    straight = np.minimum(paint, [np.inf, PAINT_SD[1], np.inf])
    gain, axis = problem.aside(state, straight, noise)
    far = float(np.hypot(*axis))
    aside = any(far > least and gain > rise for least, rise in ASIDE)
    crooked = float(paint[1]) > max(CROOKED, PIXELATED * problem.pixel(state))
    return aside or crooked or float(state.rig[POSITION][2]) > HIGHEST


@dataclass(frozen=True)
class _State:
    rig: Array
    travel: Array
    offset: Array
    views: Array

    def moved(self, step: Array) -> _State:
        shared = RIG_SIZE + self.travel.size
        cut = shared + self.views.size
        return _State(
            self.rig + step[:RIG_SIZE],
            self.travel + step[RIG_SIZE:shared].reshape(-1, 3),
            self.offset + step[cut:],
            self.views + step[shared:cut].reshape(-1, VIEW_SIZE),
        )


class _Problem:
    """Residuals, normal equations and variances; unknowns in the order rig, travel, views, offsets.

    The marks are ordered by frames and, within a frame, by the pieces they lie on: a run of marks
    is what one frame shows of one piece.
    """

    def __init__(
        self,
        frames: Sequence[Marks],
        basis: Array,
        views: Sequence[View],
        size: tuple[int, int],
        prior: Prior,
    ) -> None:
        ordered = [m.pick(np.argsort(piece_of(m), kind="stable")) for m in frames]
        marks = joined(ordered)
        self.observed = Observations(marks, size, counts=[len(m) for m in ordered])
        self.kind = family(marks.line)
        identity = piece_of(marks)
        self.pieces, self.piece = np.unique(identity, return_inverse=True)
        self.family = family(self.pieces // BINS)
        number = np.repeat(np.arange(len(frames)), self.observed.counts)
        changes = (np.diff(identity, prepend=-1) != 0) | (np.diff(number, prepend=-1) != 0)
        self.first = np.flatnonzero(changes)
        self.basis = basis[number]
        self.shared = RIG_SIZE + 3 * basis.shape[1]
        self.run_piece = self.piece[self.first]
        of_view = VIEW_SIZE * number[self.first] + np.arange(VIEW_SIZE)[:, None]
        self.run_view = self.shared + of_view
        self.by_piece = np.argsort(self.run_piece, kind="stable")
        self.piece_first = np.searchsorted(
            self.run_piece[self.by_piece], np.arange(len(self.pieces))
        )
        self.prior = prior
        self.start = np.array([v.vector for v in views])
        self.hold = 1 / np.square(VIEW_SD)

    def see(self, state: _State) -> Linear:
        """Linearise all frames."""
        points = self.observed.points(state.rig) - (self.basis @ state.travel).T
        points[:2] += self.observed.way * state.offset[self.piece]
        return linearised(self.observed, points, state.views, state.rig)

    def cost(self, state: _State, at: Linear, paint: Array, noise: Array) -> float:
        """Half the robust sum of squares."""
        off = (state.rig - self.prior.mean) / self.prior.sd
        value = float(off @ off)
        value += 2 * float(loss(state.offset / paint[self.family], WIDTH).sum())
        value += float((state.travel**2).sum()) / TRAVEL_SD**2
        value += float((self.hold * (state.views - self.start) ** 2).sum())
        value += 2 * float(loss(at.residual / noise[self.kind], WIDTH).sum())
        return value / 2

    def pixel(self, state: _State) -> float:
        """Tell how much of the ice a pixel usually shows across lines, m; 0 without any."""
        lines = self.kind == 1
        by = by_measure(self.observed, self.see(state))[lines] * self.observed.sd[lines]
        return float(np.median(1 / np.maximum(np.abs(by), 1.0))) if lines.any() else 0.0

    def weights(self, at: Linear, noise: Array) -> Array:
        """Give each residual's weight under Cauchy's loss, shape (n,)."""
        return np.asarray(1 / (noise[self.kind] ** 2 + (at.residual / WIDTH) ** 2))

    def by_shared(self, state: _State, at: Linear) -> Array:
        """Differentiate the residuals by the rig and the travel, shape (15 + 3 d, n)."""
        found = by_rig(self.observed, at, state.views)
        along = (self.basis.T[:, None] * found[POSITION]).reshape(-1, found.shape[1])
        return np.concatenate([found, along])

    def normal(self, state: _State, at: Linear, paint: Array, noise: Array) -> tuple[Arrow, Array]:
        """Assemble the normal equations: matrix and right-hand side."""
        rig, cut = slice(0, self.shared), self.shared + state.views.size
        held = np.concatenate(
            [
                1 / self.prior.sd**2,
                np.full(state.travel.size, 1 / TRAVEL_SD**2),
                np.tile(self.hold, len(state.views)),
                1 / (paint[self.family] ** 2 + (state.offset / WIDTH) ** 2),
            ]
        )
        away = [
            state.rig - self.prior.mean,
            state.travel.ravel(),
            (state.views - self.start).ravel(),
            state.offset,
        ]
        right = held * np.concatenate(away)
        w = self.weights(at, noise)
        by_shared, by_offset = self.by_shared(state, at), by_measure(self.observed, at)
        shared, own, pull = by_shared * w, at.by_view * w, w * at.residual
        dense, border = np.diag(held[:cut]), np.zeros((cut, len(self.pieces)))
        dense[rig, rig] += shared @ by_shared.T
        right[rig] += by_shared @ pull
        matrices, rights = view_equations(self.observed, at, w)
        right[self.shared : cut] += rights.ravel()
        for k, part in enumerate(self.observed.parts):
            view = slice(self.shared + VIEW_SIZE * k, self.shared + VIEW_SIZE * (k + 1))
            dense[view, view] += matrices[k]
            dense[view, rig] = own[:, part] @ by_shared[:, part].T
            dense[rig, view] = dense[view, rig].T
        if len(self.first):
            runs = np.add.reduceat(np.concatenate([shared, own]) * by_offset, self.first, axis=1)
            border[rig] = np.add.reduceat(runs[rig, self.by_piece], self.piece_first, axis=1)
            border[self.run_view, self.run_piece] = runs[self.shared :]
        right[cut:] += np.bincount(self.piece, by_offset * pull, len(self.pieces))
        held[cut:] += np.bincount(self.piece, w * by_offset**2, len(self.pieces))
        return Arrow(dense, border, held[cut:]), right

    def learn(
        self, state: _State, paint: Array, noise: Array
    ) -> tuple[_State, Array, Array, Array]:
        """Fit with the paint and the noise that the residuals show: state, covariance, both."""
        at = self.see(state)
        for step in range(ROUNDS):
            state, at, matrix = self.fit(state, at, paint, noise, FIRST if step == 0 else NEXT)
            paint, noise = self.spread(state, at, matrix.last_variances(), paint, noise)
        state, _, matrix = self.fit(state, at, paint, noise, LAST)
        return state, matrix.inverse(), paint, noise

    def gain(self, state: _State, paint: Array, noise: Array) -> float:
        """Predict the fall of the cost by one undamped Gauss-Newton step."""
        matrix, right = self.normal(state, self.see(state), paint, noise)
        return 0.5 * float(right @ matrix.solve(right))

    def aside(self, state: _State, paint: Array, noise: Array) -> tuple[float, Array]:
        """How much better the marks fit if the lens's axis need not be in the picture's middle.

        Where linear residuals have their least.

        Returns
        -------
        gain : float
            By how much the cost falls.
        axis : ndarray, shape (2,)
            Where the axis then is, half diagonals from the middle.
        """
        at, free = self.see(state), copy(self)
        # An axis aside would make up for a wrong height that somebody says.
        free.prior = self.prior.as_found(float(state.rig[POSITION][2]))
        matrix, right = free.normal(state, at, paint, noise)
        by_axis = self.observed.normal
        weighted = by_axis * self.weights(at, noise)
        by_shared, by_offset = self.by_shared(state, at), by_measure(self.observed, at)
        by_view = [at.by_view[:, part] @ weighted[:, part].T for part in self.observed.parts]
        by_piece = [np.bincount(self.piece, by_offset * w, len(self.pieces)) for w in weighted]
        beside = np.concatenate([by_shared @ weighted.T, *by_view, np.transpose(by_piece)])
        follows = np.array([matrix.solve(column) for column in beside.T])
        own = weighted @ by_axis.T + np.eye(2) / AXIS_SD**2 - follows @ beside
        pull = weighted @ at.residual - follows @ right
        axis = -np.linalg.solve(own, pull)
        return -0.5 * float(axis @ pull), axis

    def fit(
        self, state: _State, at: Linear, paint: Array, noise: Array, iterations: int
    ) -> tuple[_State, Linear, Arrow]:
        """Gauss-Newton with damping; the state, what is seen from it, and the normal matrix."""
        cost, damping = self.cost(state, at, paint, noise), 1e-6
        matrix, right = self.normal(state, at, paint, noise)
        for _ in range(iterations):
            ahead = state.moved(-matrix.solve(right, damping))
            ahead = self.settled(ahead, self.see(ahead), noise)
            looked = self.see(ahead)
            new = self.cost(ahead, looked, paint, noise)
            if not new <= cost:
                damping = max(damping, 1e-6) * 30
                continue
            done = cost - new < SETTLED
            state, at, cost = ahead, looked, new
            matrix, right = self.normal(state, at, paint, noise)
            if done:
                break
        return state, at, matrix

    def settled(self, state: _State, at: Linear, noise: Array) -> _State:
        """Take one more Gauss-Newton step in each view alone, with what frames share held.

        From overhead, height, focal length and tilt hardly tell themselves apart: a joint step
        along the tangent of that valley would leave it where it bends.
        """
        matrices, right = view_equations(self.observed, at, self.weights(at, noise))
        right += self.hold * (state.views - self.start)
        held = np.diag(self.hold + BLIND)  # a step too far may end below the ice
        step = np.linalg.solve(matrices + held, right[..., None])[..., 0]
        return replace(state, views=state.views - step)

    def spread(
        self, state: _State, at: Linear, variance: Array, paint: Array, noise: Array
    ) -> tuple[Array, Array]:
        """Estimate the paint's and the marks' standard deviations anew; `variance` of offsets."""
        sure = 1 / (1 + (state.offset / paint[self.family] / WIDTH) ** 2)
        squares, counts = PAINT_TRUST * PAINT_SD**2, np.full(FAMILIES, PAINT_TRUST)
        off = sure * (state.offset**2 + variance)
        squares = squares + np.bincount(self.family, off, FAMILIES) / LOST
        counts = counts + np.bincount(self.family, sure, FAMILIES)
        fresh = np.sqrt(squares / counts)
        residual, kinds = at.residual, self.kind
        w = 1 / (1 + (residual / noise[kinds] / WIDTH) ** 2)
        # What the fit has taken up: one per unknown, as far as the data rather than priors fix it.
        taken = np.bincount(self.family, 1 - variance / paint[self.family] ** 2, FAMILIES)
        taken[0] += VIEW_SIZE * len(state.views)
        most = np.bincount(kinds, w, FAMILIES)
        squares = np.bincount(kinds, w * residual**2, FAMILIES) / LOST
        free = np.maximum(most - taken, 0.2 * most)
        return fresh, np.sqrt((squares + NOISE_TRUST) / (free + NOISE_TRUST))
