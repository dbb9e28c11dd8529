"""A fit of a whole shot as a value: the pieces' motions, the hits' times, their covariance."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.slowing import course, motion, stop_after, velocities
from curlshot.physics.local_fit.segments import Piece

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Deceleration:
    """Prior of the acceleration on one piece, m/s².

    ``mean`` against the motion at 1 m/s with standard deviation ``along``; ``across`` it zero
    mean. Of ``mean`` a ``share`` ± ``sd_share`` fades with the speed as by FCV1.
    """

    mean: float = 0.0
    along: float = 1.0
    across: float = 1.0
    share: float = 0.0
    sd_share: float = 0.0


@dataclass(frozen=True)
class Meeting:
    """A hit, or what may be one, as the fit needs it: time and its looseness, s; stones."""

    t: float
    stones: tuple[str, str]
    looseness: float


@dataclass(frozen=True)
class ContactState:
    """Places, and velocities before and after, of the two stones of a hit at its time."""

    t: float
    places: Floats
    before: Floats
    after: Floats

    @property
    def normal(self) -> Floats:
        """Unit vector from the first stone to the second."""
        apart = self.places[1] - self.places[0]
        out: Floats = apart / np.hypot(*apart)
        return out


@lru_cache(maxsize=256)
def _motion(x: bytes, tau: float, power: float) -> tuple[Floats, Floats]:
    """As `motion`: derivatives by each unknown ask for all pieces, and move one of them."""
    place, speed = motion(np.frombuffer(x).reshape(2, 3), tau, power)
    place.flags.writeable = speed.flags.writeable = False  # all who ask share them
    return place, speed


PLACE, VELOCITY, ACCELERATION, POWER = [0, 3], [1, 4], [2, 5], 6
"""Ranks among the unknowns of one piece, by axis: x, vx, ax, y, vy, ay and the power."""


@lru_cache(maxsize=256)
def unknowns_of(rank: int, pieces: int) -> NDArray[np.int64]:
    """Where among the unknowns of a fit those of one of its pieces are: its state, its power."""
    found = np.append(np.arange(6 * rank, 6 * rank + 6), rank - pieces)
    found.flags.writeable = False  # all who ask share them
    return found


def times_of(pieces: int, meetings: int) -> slice:
    """Where among the unknowns of a fit the times of its meetings are."""
    return slice(6 * pieces, 6 * pieces + meetings)


@dataclass(frozen=True)
class LocalFit:
    """Result of `curlshot.physics.local_fit.fit.fit_shot`.

    Attributes
    ----------
    pieces : tuple of Piece
        With the samples as assigned at the end.
    meetings : tuple of Meeting
        As given.
    theta : (7 P + M,) array
        Per piece x, vx, ax, y, vy, ay at `origins`; then the times of the meetings; then per
        piece the exponent p of its deceleration (`curlshot.physics.filter.slowing`).
    cov : (7 P + M, 7 P + M) array
        Covariance, enlarged for residuals that are too big or alike from frame to frame.
    origins : (P,) array
        Time at which a piece's state is given, s.
    inflation : float
        Factor that `cov` was enlarged by.
    sides : mapping
        Rank of meeting and stone to the ranks of the pieces before and after.
    """

    pieces: tuple[Piece, ...]
    meetings: tuple[Meeting, ...]
    theta: Floats
    cov: Floats
    origins: Floats
    inflation: float
    sides: Mapping[tuple[int, str], tuple[int, int]]

    def motion(self, rank: int, t: float, theta: Floats | None = None) -> tuple[Floats, Floats]:
        """Place and velocity on piece `rank` at time t."""
        own = (self.theta if theta is None else theta)[self.unknowns(rank)]
        return _motion(own[:6].tobytes(), t - float(self.origins[rank]), float(own[POWER]))

    def places(self, rank: int, t: Floats) -> Floats:
        """Places on piece `rank` at times t, shape (n, 2)."""
        return course(self.state(rank), t - self.origins[rank], self.power(rank))[0]

    def speeds(self, rank: int, t: Floats) -> Floats:
        """Velocities on piece `rank` at times t, shape (n, 2)."""
        return velocities(self.state(rank), t - self.origins[rank], self.power(rank))

    def stop(self, rank: int) -> float:
        """Time at which the stone of piece `rank` stops, s."""
        return float(self.origins[rank]) + stop_after(self.state(rank), self.power(rank))

    def state(self, rank: int) -> Floats:
        """Place, velocity and acceleration of piece `rank` at its origin, shape (2, 3)."""
        return self.theta[self.unknowns(rank)[:POWER]].reshape(2, 3)

    def power(self, rank: int) -> float:
        """Exponent p of the deceleration on piece `rank`, which goes as v^(−p)."""
        return float(self.theta[self.unknowns(rank)[POWER]])

    def unknowns(self, rank: int) -> NDArray[np.int64]:
        """Where in `theta` those of piece `rank` are: its state, then its power."""
        return unknowns_of(rank, len(self.pieces))

    def time(self, k: int, theta: Floats | None = None) -> float:
        """Time of meeting k, s."""
        return float((self.theta if theta is None else theta)[self._times][k])

    def stderr_time(self, k: int) -> float:
        """Give the standard error of the time of meeting k, s."""
        return float(np.sqrt(np.diag(self.cov)[self._times][k]))

    @property
    def _times(self) -> slice:
        return times_of(len(self.pieces), len(self.meetings))

    def contact_state(self, k: int, theta: Floats | None = None) -> ContactState:
        """State of the two stones at meeting k."""
        t = self.time(k, theta)
        places, before, after = [], [], []
        for stone in self.meetings[k].stones:
            first, second = self.sides[k, stone]
            place, speed = self.motion(first, t, theta)
            places.append(place)
            before.append(speed)
            after.append(self.motion(second, t, theta)[1])
        return ContactState(t, np.array(places), np.array(before), np.array(after))

    def propagate(
        self, hits: Sequence[int], function: Callable[[Sequence[ContactState]], Floats]
    ) -> tuple[Floats, Floats]:
        """Value and covariance of a function of the states at some hits, to first order.

        Parameters
        ----------
        hits : sequence of int
            Ranks of the meetings whose states `function` takes.
        function : callable
            From these states to m numbers.

        Returns
        -------
        value : (m,) array
        cov : (m, m) array
        """
        ranks = sorted({r for k in hits for s in self.meetings[k].stones for r in self.sides[k, s]})
        own = [self.unknowns(rank).tolist() for rank in ranks]
        index = [i for each in own for i in each[:POWER]]
        index += [self._times.start + k for k in hits]
        index += [each[POWER] for each in own]
        value = np.atleast_1d(function([self.contact_state(k) for k in hits]))
        slopes = np.zeros((len(value), len(index)))
        for column, i in enumerate(index):
            step = 0.01 * float(np.sqrt(max(self.cov[i, i], 1e-24)))
            ends = []
            for sign in (1.0, -1.0):
                moved = self.theta.copy()
                moved[i] += sign * step
                ends.append(np.atleast_1d(function([self.contact_state(k, moved) for k in hits])))
            slopes[:, column] = (ends[0] - ends[1]) / (2 * step)
        return value, slopes @ self.cov[np.ix_(index, index)] @ slopes.T
