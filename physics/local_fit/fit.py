"""One least-squares fit of a whole shot, hit by hit joined.

Between hits each stone moves with an acceleration that is mostly against its motion, and grows
as a power of the speed that is lost, until it stops. At a hit the paths on either side meet, the
centres are two radii apart, and the momentum of the two stones is the same before and after. All
of this is nearly linear in the unknowns, so a few Gauss-Newton steps find it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.slowing import LEAST, MOST, course, power_prior, stop_after
from curlshot.physics.local_fit.breaks import FEWEST
from curlshot.physics.local_fit.constraints import acceleration_prior, contact_constraints
from curlshot.physics.local_fit.segments import Piece
from curlshot.physics.local_fit.solution import (
    ACCELERATION,
    PLACE,
    POWER,
    VELOCITY,
    Deceleration,
    LocalFit,
    Meeting,
    times_of,
    unknowns_of,
)
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.statistics.normal_equations import eliminated, inverse_of_blocks
from curlshot.physics.statistics.residuals import huber_weights, inflation

Floats = NDArray[np.float64]

STEPS, USUAL = 15, 8
"""Most Gauss-Newton steps, and how many are whole: most fits settle in seven. Where a stone hardly
moves its end goes to and fro from one whole step to the next, and half of them settle."""

FARTHEST = 100.0
"""Longest step of any state (SI units), so that a fit of nonsense ends."""

STILL_SD = 1e-5
"""How still a stone at rest lies, m/s and m/s²."""


def fit_shot(
    traces: Mapping[str, Trace],
    pieces: Sequence[Piece],
    meetings: Sequence[Meeting],
    radius: float,
    *,
    masses: Mapping[str, float] | None = None,
    deceleration: Deceleration | None = None,
    momentum: bool = True,
    still: Sequence[Floats] = (),
) -> LocalFit:
    """Fit all pieces and the times of all meetings at once.

    Parameters
    ----------
    traces : mapping
        Stone to its detections.
    pieces : sequence of Piece
        All pieces to fit; each meeting must open and close one of either stone.
    meetings : sequence of Meeting
        The hits, with starting values of their times.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.
    deceleration : Deceleration, optional
        Prior of the acceleration on each piece that moves.
    momentum : bool
        Whether each pair's momentum is held (otherwise only their paths are joined).
    still : sequence of (n, 2) array
        Normalised residuals of stones that never move, for how alike errors are in time.
    """
    prior = deceleration or Deceleration()
    return _Solver(traces, pieces, meetings, radius, masses or {}, prior, momentum, still).solve()


class _Solver:
    """Working state of one fit."""

    def __init__(
        self,
        traces: Mapping[str, Trace],
        pieces: Sequence[Piece],
        meetings: Sequence[Meeting],
        radius: float,
        masses: Mapping[str, float],
        deceleration: Deceleration,
        momentum: bool,
        still: Sequence[Floats],
    ) -> None:
        self.traces, self.pieces, self.meetings = traces, list(pieces), tuple(meetings)
        self.radius, self.masses = radius, masses
        self.prior, self.momentum = deceleration, momentum
        self.still = [(residuals, 1) for residuals in still]
        self.inflation = 1.0
        self.own = [unknowns_of(i, len(self.pieces)) for i in range(len(self.pieces))]
        self.times = times_of(len(self.pieces), len(self.meetings))
        self.size = 7 * len(self.pieces) + len(self.meetings)
        opened = {(p.opens, p.stone): i for i, p in enumerate(pieces) if p.opens is not None}
        self.sides = {
            (p.closes, p.stone): (i, opened[p.closes, p.stone])
            for i, p in enumerate(pieces)
            if p.closes is not None
        }
        self.further = np.zeros((len(self.pieces), 2, 8))
        self.courses: dict[int, tuple[Floats, Floats, Floats]] = {}
        self.left: dict[int, Floats] = {}
        self.blocks = self._blocks()
        self.origins = np.array([_origin(p, traces[p.stone], meetings) for p in pieces])
        self.theta = np.zeros(self.size)
        self.theta[self.times] = [meeting.t for meeting in self.meetings]
        for own, piece, origin in zip(self.own, self.pieces, self.origins, strict=True):
            guess = _first_guess(piece, traces[piece.stone], origin)
            self.theta[own] = [*guess.ravel(), self._power_prior(guess[:, 1])[0]]

    def _blocks(self) -> list[NDArray[np.int64]]:
        """Unknowns that depend on each other: pieces are tied to others by meetings alone."""
        count = len(self.pieces)
        group = np.arange(count + len(self.meetings))
        for (k, _), pair in self.sides.items():
            for rank in pair:
                group[group == group[rank]] = group[count + k]
        unknowns = np.concatenate([np.repeat(group[:count], 6), group[count:], group[:count]])
        order = np.argsort(unknowns, kind="stable")
        return np.split(order, np.flatnonzero(np.diff(unknowns[order])) + 1)

    def solve(self) -> LocalFit:
        states, powers = slice(self.times.start), slice(self.times.stop, None)
        settled = False
        for done in range(STEPS):
            self._assign()
            data, right = self._detections()
            held, held_right = self._constraints()
            cov = inverse_of_blocks(data + held, self.blocks)
            new = cov @ (right + held_right)
            step = new - self.theta
            bounds = [self._time_bounds(k) for k in range(len(self.meetings))]
            step[self.times] = np.clip(step[self.times], *np.reshape(bounds, (-1, 2)).T)
            step[states] = np.clip(step[states], -FARTHEST, FARTHEST)
            power = self.theta[powers]
            step[powers] = np.clip(power + step[powers], LEAST, MOST) - power
            scale = np.sqrt(np.maximum(np.diag(cov), 1e-24))
            settled = bool(np.all(np.abs(step) < 0.02 * scale))
            self.theta = self.theta + (0.5 if done >= USUAL else 1.0) * step
            self._forget(step)
            self.inflation = self._inflation(float(np.sum(cov * data)))
            if settled:
                break
        return LocalFit(
            tuple(self.pieces),
            self.meetings,
            self.theta,
            cov * self.inflation,
            self.origins,
            self.inflation,
            self.sides,
        )

    def _forget(self, step: Floats) -> None:
        """Let go of what is known of pieces that a step has moved, or that drift anew."""
        for i, piece in enumerate(self.pieces):
            if not piece.rest or step[self.own[i][PLACE]].any():
                self.courses.pop(i, None)
                self.left.pop(i, None)

    def _time_bounds(self, k: int) -> tuple[float, float]:
        """Least and most that the time of meeting k may move in one step."""
        meeting = self.meetings[k]
        times = self.theta[self.times]
        loose = meeting.looseness
        low = max(meeting.t - 3 * loose - times[k], -loose)
        high = min(meeting.t + 3 * loose - times[k], loose)
        for other, t in enumerate(times):
            # Hits of one stone stay in their order.
            if other != k and not set(self.meetings[other].stones).isdisjoint(meeting.stones):
                if self.meetings[other].t <= meeting.t:
                    low = max(low, 0.49 * (t - times[k]))
                else:
                    high = min(high, 0.49 * (t - times[k]))
        return min(low, 0.0), max(high, 0.0)

    def _assign(self) -> None:
        """Give each detection beside a hit to the side of it that it lies on."""
        for (k, stone), (i, j) in self.sides.items():
            t = self.theta[self.times][k]
            both = np.concatenate([self.pieces[i].samples, self.pieces[j].samples])
            early = self.traces[stone].t[both] < t
            for rank, samples in ((i, both[early]), (j, both[~early])):
                if len(samples) != len(self.pieces[rank].samples):
                    self.pieces[rank] = replace(self.pieces[rank], samples=samples)
                    self.courses.pop(rank, None)
                    self.left.pop(rank, None)

    def _motion(self, i: int) -> tuple[Floats, float]:
        """State of a piece at its origin, shape (2, 3), and the power that slows it."""
        own = self.theta[self.own[i]]
        return own[:POWER].reshape(2, 3), float(own[POWER])

    def _course(self, i: int) -> tuple[Floats, Floats, Floats]:
        """Give times of a piece's detections from its origin, s, its places, their derivatives.

        Times go on no more once it rests.
        """
        if i not in self.courses:
            piece, (x, power) = self.pieces[i], self._motion(i)
            tau = self.traces[piece.stone].t[piece.samples] - self.origins[i]
            tau = np.minimum(tau, 0.0 if piece.rest else stop_after(x, power))
            if piece.rest:
                slopes = np.zeros((len(tau), 2, 7))
                slopes[:, [0, 1], PLACE] = 1.0
                self.courses[i] = tau, np.tile(x[:, 0], (len(tau), 1)), slopes
            else:
                self.courses[i] = tau, *course(x, tau, power)
        return self.courses[i]

    def _residuals(self, i: int) -> Floats:
        if i not in self.left:
            piece = self.pieces[i]
            trace, (tau, fitted, _) = self.traces[piece.stone], self._course(i)
            drift = self.further[i] @ np.append(-self.theta[self.own[i]], 1.0)
            off = trace.xy[piece.samples] - fitted - tau[:, None] * drift
            self.left[i] = off / trace.sd[piece.samples]
        return self.left[i]

    def _detections(self) -> tuple[Floats, Floats]:
        """Set up the normal equations of the detections, outliers weighted down."""
        normal, right = np.zeros((self.size, self.size)), np.zeros(self.size)
        for i, piece in enumerate(self.pieces):
            if not len(piece.samples):
                continue
            trace = self.traces[piece.stone]
            own = self.own[i]
            weights = huber_weights(self._residuals(i)) / trace.sd[piece.samples] ** 2
            normal[np.ix_(own, own)], right[own] = self._piece_equations(i, weights)
        return normal, right

    def _piece_equations(self, i: int, weights: Floats) -> tuple[Floats, Floats]:
        """Set up the normal equations of one piece's detections, of its own unknowns.

        Two further unknowns are eliminated at once: what the detections say of the velocity is
        wrong by what they share, on either axis.
        """
        piece, own = self.pieces[i], self.theta[self.own[i]]
        places = self.traces[piece.stone].xy[piece.samples]
        if piece.rest:
            normal, right = np.zeros((7, 7)), np.zeros(7)
            normal[PLACE, PLACE], right[PLACE] = weights.sum(0), (weights * places).sum(0)
            return normal, right
        tau, fitted, slopes = self._course(i)
        seen = places - fitted + slopes @ own
        speed = float(np.hypot(*own[VELOCITY]))
        shared = tau[:, None, None] * np.eye(2)
        rows = np.concatenate([slopes, shared], axis=2).reshape(-1, 9)
        full = rows.T @ (weights.reshape(-1, 1) * rows)
        value = rows.T @ (weights * seen).ravel()
        drift = speed * np.median(self.traces[piece.stone].sd_scale[piece.samples], axis=0)
        known = drift**2 / self.inflation
        normal, right, self.further[i] = eliminated(full, value, known)
        return normal, right

    def _constraints(self) -> tuple[Floats, Floats]:
        """Set up the normal equations of what is known besides the detections."""
        normal, right = np.zeros((self.size, self.size)), np.zeros(self.size)
        for own, piece in zip(self.own, self.pieces, strict=True):
            place, speed, change = own[PLACE], own[VELOCITY], own[ACCELERATION]
            power = own[POWER]
            usual, unsure = self._power_prior(self.theta[speed])
            normal[power, power] += unsure**-2
            right[power] += unsure**-2 * usual
            normal[place, place] += 1e-8
            if piece.rest:
                normal[speed, speed] += STILL_SD**-2
                normal[change, change] += STILL_SD**-2
                continue
            normal[speed, speed] += 1e-3
            turn, mean = acceleration_prior(self.theta[speed], self.prior)
            normal[np.ix_(change, change)] += turn
            right[change] += turn @ mean
        for k in range(len(self.meetings)):
            meeting = self.meetings[k]
            ranks = [self.sides[k, stone] for stone in meeting.stones]
            masses = np.array([self.masses.get(stone, 1.0) for stone in meeting.stones])
            rows, values, sd = contact_constraints(
                self.theta, self.times.start + k, self.origins, meeting, ranks, self.radius,
                masses if self.momentum else None,
            )  # fmt: skip
            weighted = rows / sd[:, None] ** 2
            normal += weighted.T @ rows
            right += weighted.T @ (rows @ self.theta - values)
        return normal, right

    def _power_prior(self, speed: Floats) -> tuple[float, float]:
        """Power of the speed that slows a stone of a velocity, m/s, and its standard error."""
        return power_prior(float(np.hypot(*speed)), self.prior.share, self.prior.sd_share)

    def _inflation(self, parameters: float) -> float:
        """Factor for residuals larger than stated, and alike from frame to frame."""
        runs = [
            (self._residuals(i), 1 if piece.rest else 3)
            for i, piece in enumerate(self.pieces)
            if len(piece.samples)
        ]
        return inflation(runs, sum(run.size for run, _ in runs) - parameters, self.still)


def _origin(piece: Piece, trace: Trace, meetings: Sequence[Meeting]) -> float:
    """Time at which a piece's state is given, s: of the hit that opens it, else its first.

    Of a stone at rest it is that of the hit which ends it: there its state is asked for, and how
    still it lies would move it within a minute.
    """
    if piece.rest and piece.closes is not None:
        return meetings[piece.closes].t
    if piece.opens is not None:
        return meetings[piece.opens].t
    if len(piece.samples):
        return float(trace.t[piece.samples[0]])
    return piece.start if np.isfinite(piece.start) else piece.end


def _first_guess(piece: Piece, trace: Trace, start: float) -> Floats:
    """Place, velocity and acceleration of a piece at a time, shape (2, 3).

    By a straight line, without an acceleration; one that stops by the first half of its way, as if
    it was slowed evenly: how long it then rests tells nothing of its motion. At rest all but the
    place is 0. The shortest pieces use the detections beside them too.
    """
    samples = piece.samples
    if len(samples) < 3:
        low = max(int(np.searchsorted(trace.t, piece.start)) - 1, 0)
        high = min(int(np.searchsorted(trace.t, piece.end)) + 1, len(trace.t))
        samples = np.arange(low, high)
    t, places = trace.t[samples], trace.xy[samples]
    if piece.rest or len(samples) < 2:
        return np.column_stack([places.mean(0), np.zeros((2, 2))])
    way = 0.0
    if piece.stops:
        left = np.hypot(*(places - np.median(places[len(places) // 2 :], axis=0)).T)
        way = max(float(left[0]), 1e-6)
        half = max(int(np.argmax(left < 0.5 * way)), FEWEST)
        t, places = t[:half], places[:half]
    late = t - t.mean()
    speed = late @ places / (late @ late)
    place = places.mean(0) + (start - t.mean()) * speed
    if not way:
        return np.column_stack([place, speed, np.zeros(2)])
    # Evenly slowed, a stone goes the first half of its way at so much of its first speed.
    speed = speed / (0.5 + np.sqrt(0.125))
    return np.column_stack([place, speed, -speed * np.hypot(*speed) / (2 * way)])
