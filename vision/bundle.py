"""What the frames of a clip share, fitted to many of them at once.

The unknowns are the rig (place, lens, painted measures), each frame's view, and the paint: how
far each piece of a painted line lies off its nominal course. Edge points of one piece, in however
many frames, share that error: so it, not the number of points, limits what can be known. How
large such errors are, and the noise of single points, is learned from the residuals themselves
by expectation and maximisation: Dempster, Laird and Rubin, 1977, Journal of the Royal Statistical
Society B 39, 1. Bundle adjustment: Triggs et al., 2000, LNCS 1883.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vision.adjust import VIEW_SD, WIDTH, Frame, Linear, by_rig, inverse, linearised
from vision.pose import CIRCLES, FIXED, RIG_SIZE, VIEW_SIZE, Marks, Prior, View

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

ARC = np.radians(15.0)
"""Length of a piece of a circle, rad."""

PIECE = 0.4
"""Length of a piece of a line, m."""

_BINS = 1000
"""Pieces a line may have; the identity of a piece is its line's number times this, plus its own."""

FAMILIES = 3

PAINT_SD = np.array([0.002, 0.002, 1.0])
"""What is expected of the paint of circles and of lines, m; fixed points have none."""

PAINT_TRUST = 6.0
"""Pieces of paint that this expectation is worth."""

NOISE_TRUST = 10.0
"""Marks that their stated standard deviation is worth against their residuals."""

LOST = 0.85
"""Expected w r² of a normal residual over the expected w, Cauchy weights of width 3."""

ROUNDS = 4
"""Estimates of paint and noise, each followed by a fit."""


@dataclass(frozen=True)
class Bundle:
    """What frames share.

    Attributes
    ----------
    rig : ndarray, shape (14,)
    pieces : ndarray of int, shape (c,)
        Identities of the pieces of paint, ascending (see `piece_of`).
    offset : ndarray, shape (c,)
        How far each lies off its line, m.
    cov : ndarray, shape (14 + c, 14 + c)
        Covariance of rig and offsets.
    noise : ndarray, shape (3,)
        Standard deviation of a single mark on a circle, on a line, of a fixed point, in stated
        ones.
    """

    rig: Array
    pieces: Ints
    offset: Array
    cov: Array
    noise: Array

    def offsets(self, marks: Marks) -> tuple[Array, Ints]:
        """Offset of the paint under each mark, m, and the place of its piece; 0, −1 if unseen."""
        wanted = piece_of(marks)
        at = np.minimum(np.searchsorted(self.pieces, wanted), len(self.pieces) - 1)
        known = self.pieces[at] == wanted
        return np.where(known, self.offset[at], 0.0), np.where(known, at, -1)


def piece_of(marks: Marks) -> Ints:
    """Identity of the piece of paint that each mark lies on."""
    length = np.where(marks.line < CIRCLES, ARC, PIECE)
    number = np.floor(marks.along / length).astype(np.int64) + _BINS // 2
    return np.asarray(marks.line * _BINS + np.clip(number, 0, _BINS - 1))


def family(line: Ints) -> Ints:
    """Tell circles (0), lines (1) and fixed points (2) apart."""
    return np.asarray((line >= CIRCLES).astype(np.int64) + (line == FIXED), np.int64)


class _Look:
    """One frame's marks, ordered by the pieces they lie on."""

    def __init__(self, marks: Marks, size: tuple[int, int]) -> None:
        identity = piece_of(marks)
        order = np.asarray(np.argsort(identity, kind="stable"), np.int64)
        self.frame = Frame(marks.pick(order), size)
        self.family = family(self.frame.line)
        self.identity, self.first = np.unique(identity[order], return_index=True)
        self.count = np.diff(np.append(self.first, len(marks)))


def bundle(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    prior: Prior,
    *,
    view_sd: ArrayLike = VIEW_SD,
) -> tuple[Bundle, tuple[View, ...]]:
    """Fit what frames share, and their views.

    Parameters
    ----------
    frames : sequence of Marks
        Not empty.
    views : sequence of View
        Start values, one per frame, and the centres of the weak prior `view_sd`.
    rig : ndarray, shape (14,)
        Start values of the shared part.
    size : tuple of int
        Width and height of the picture, px.
    prior : Prior
    """
    problem = _Problem(frames, views, size, prior, view_sd)
    state = _State(rig, np.zeros(len(problem.pieces)), np.array([v.vector for v in views]))
    paint, noise = PAINT_SD, np.ones(FAMILIES)
    for step in range(ROUNDS):
        state, cov = problem.fit(state, paint, noise, 6 if step == 0 else 2)
        paint, noise = problem.spread(state, cov, paint, noise)
    state, cov = problem.fit(state, paint, noise, 4)
    shared = RIG_SIZE + len(problem.pieces)
    found = Bundle(state.rig, problem.pieces, state.offset, cov[:shared, :shared], noise)
    return found, tuple(View(v) for v in state.views)


@dataclass(frozen=True)
class _State:
    rig: Array
    offset: Array
    views: Array

    def moved(self, step: Array) -> _State:
        cut = RIG_SIZE + len(self.offset)
        return _State(
            self.rig + step[:RIG_SIZE],
            self.offset + step[RIG_SIZE:cut],
            self.views + step[cut:].reshape(-1, VIEW_SIZE),
        )


class _Problem:
    """Residuals, normal equations and variances; unknowns in the order rig, offsets, views."""

    def __init__(
        self,
        frames: Sequence[Marks],
        views: Sequence[View],
        size: tuple[int, int],
        prior: Prior,
        view_sd: ArrayLike,
    ) -> None:
        self.looks = [_Look(m, size) for m in frames]
        self.pieces = np.unique(np.concatenate([k.identity for k in self.looks]))
        self.where = [np.searchsorted(self.pieces, k.identity) for k in self.looks]
        self.family = family(self.pieces // _BINS)
        self.prior = prior
        self.start = np.array([v.vector for v in views])
        self.hold = 1 / np.asarray(view_sd, float) ** 2

    def see(self, state: _State) -> list[Linear]:
        """Linearise every frame."""
        seen = []
        for look, where, view in zip(self.looks, self.where, state.views, strict=True):
            points = look.frame.points(state.rig)
            points[:2] += look.frame.way * np.repeat(state.offset[where], look.count)
            seen.append(linearised(look.frame, points, view, state.rig))
        return seen

    def cost(self, state: _State, seen: Sequence[Linear], paint: Array, noise: Array) -> float:
        """Half the robust sum of squares."""
        off = (state.rig - self.prior.mean) / self.prior.sd
        value = float(off @ off + ((state.offset / paint[self.family]) ** 2).sum())
        value += float((self.hold * (state.views - self.start) ** 2).sum())
        for look, at in zip(self.looks, seen, strict=True):
            r = at.residual / noise[look.family] / WIDTH
            value += float(WIDTH**2 * np.log1p(r * r).sum())
        return value / 2

    def normal(
        self, state: _State, seen: Sequence[Linear], paint: Array, noise: Array
    ) -> tuple[Array, Array]:
        """Assemble the normal equations: matrix and right-hand side."""
        count = len(self.pieces)
        cut = RIG_SIZE + count
        size = cut + state.views.size
        matrix, right = np.zeros((size, size)), np.zeros(size)
        weight = np.concatenate(
            [1 / self.prior.sd**2, 1 / paint[self.family] ** 2, np.tile(self.hold, len(seen))]
        )
        matrix.flat[:: size + 1] = weight
        right[:RIG_SIZE] = state.rig - self.prior.mean
        right[RIG_SIZE:cut] = state.offset
        right[cut:] = (state.views - self.start).ravel()
        right *= weight
        for k, (look, where, at) in enumerate(zip(self.looks, self.where, seen, strict=True)):
            sd = noise[look.family]
            w = 1 / (sd**2 + (at.residual / WIDTH) ** 2)
            rows = np.concatenate([by_rig(look.frame, at, state.views[k]), at.by_view])
            by_offset = _by_offset(look.frame, at)
            columns = np.append(np.arange(RIG_SIZE), cut + VIEW_SIZE * k + np.arange(VIEW_SIZE))
            matrix[np.ix_(columns, columns)] += (rows * w) @ rows.T
            right[columns] += rows @ (w * at.residual)
            if len(look.first):
                mixed = np.add.reduceat(rows * (w * by_offset), look.first, axis=1)
                place = RIG_SIZE + where
                matrix[columns[:, None], place] += mixed
                matrix[place[:, None], columns] += mixed.T
                matrix[place, place] += np.add.reduceat(w * by_offset**2, look.first)
                right[place] += np.add.reduceat(w * by_offset * at.residual, look.first)
        return matrix, right

    def fit(
        self, state: _State, paint: Array, noise: Array, iterations: int
    ) -> tuple[_State, Array]:
        """Gauss-Newton with damping; the state and its covariance."""
        seen = self.see(state)
        cost, damping = self.cost(state, seen, paint, noise), 1e-6
        matrix, right = self.normal(state, seen, paint, noise)
        for _ in range(iterations):
            damped = matrix.copy()
            damped.flat[:: len(right) + 1] *= 1 + damping
            ahead = state.moved(-np.asarray(np.linalg.solve(damped, right), np.float64))
            looked = self.see(ahead)
            new = self.cost(ahead, looked, paint, noise)
            if not new <= cost:
                damping = max(damping, 1e-6) * 30
                continue
            done = cost - new < 1e-3 * (1 + 1e-3 * cost)
            state, seen, cost = ahead, looked, new
            matrix, right = self.normal(state, seen, paint, noise)
            if done:
                break
        return state, inverse(matrix)

    def spread(self, state: _State, cov: Array, paint: Array, noise: Array) -> tuple[Array, Array]:
        """Estimate the paint's and the marks' standard deviations anew."""
        variance = np.diagonal(cov)[RIG_SIZE : RIG_SIZE + len(self.pieces)]
        squares, counts = PAINT_TRUST * PAINT_SD**2, np.full(FAMILIES, PAINT_TRUST)
        squares = squares + np.bincount(self.family, state.offset**2 + variance, FAMILIES)
        counts = counts + np.bincount(self.family, minlength=FAMILIES)
        fresh = np.sqrt(squares / counts)
        seen = self.see(state)
        residual = np.concatenate([at.residual for at in seen])
        kinds = np.concatenate([k.family for k in self.looks])
        w = 1 / (1 + (residual / noise[kinds] / WIDTH) ** 2)
        # What the fit has taken up: one per unknown, as far as the data rather than priors fix it.
        taken = np.bincount(self.family, 1 - variance / paint[self.family] ** 2, FAMILIES)
        taken[0] += VIEW_SIZE * len(seen)
        most = np.bincount(kinds, w, FAMILIES)
        squares = np.bincount(kinds, w * residual**2, FAMILIES) / LOST
        free = np.maximum(most - taken, 0.2 * most)
        return fresh, np.sqrt((squares + NOISE_TRUST) / (free + NOISE_TRUST))


def _by_offset(frame: Frame, at: Linear) -> Array:
    """Differentiate the residuals by a shift of the paint along its measure."""
    by_ice = at.rotation[:, :2].T @ at.by_point
    return np.asarray((by_ice * frame.way).sum(0))


def sensitivity(
    frame: Frame, at: Linear, view: Array, w: Array, cov: Array, piece: Ints, shared: int
) -> Array:
    """How a view follows rig and offsets when fitted with these held, shape (4, shared)."""
    weighted = at.by_view * w
    found = np.zeros((VIEW_SIZE, shared))
    found[:, :RIG_SIZE] = weighted @ by_rig(frame, at, view).T
    known = piece >= 0
    mixed = (weighted * _by_offset(frame, at))[:, known]
    for row, values in zip(found, mixed, strict=True):
        row[RIG_SIZE:] = np.bincount(piece[known], values, shared - RIG_SIZE)
    return -cov @ found
