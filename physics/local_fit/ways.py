"""Which way a stone goes where it is out of sight: as it was last seen, and as it is seen next."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.candidates import OUT_OF_SIGHT
from curlshot.physics.local_fit.traces import Trace

Floats = NDArray[np.float64]

WINDOW, FEWEST = 0.25, 5
"""Time, s, and detections at the end of a gap that show how a stone goes there: longer may have
another hit in them."""

SLOWING, SLOWING_SD = 0.1, 0.03
"""How ice slows stones, m/s²: what is known beforehand."""

STILL = 0.02
"""Speed, m/s, below which a stone is at rest: ice stops it within a quarter of a second."""

MISS = 4.0
"""Standard errors beyond which a stone is not where ice and its own way take it."""


@dataclass(frozen=True)
class Way:
    """How a stone goes at one end of a gap.

    Attributes
    ----------
    t : float
        Of the detection at the end, s.
    place, velocity : (2,) array
        m and m/s; the velocity is 0 of a stone at rest.
    sd_place, sd_speed : float
        Their standard errors on either axis.
    """

    t: float
    place: Floats
    velocity: Floats
    sd_place: float
    sd_speed: float

    @property
    def speed(self) -> float:
        """In m/s."""
        return float(np.hypot(*self.velocity))

    def at(self, t: Floats) -> Floats:
        """Give its places (n, 2) at times, s: it comes to rest, and has been faster before."""
        if not self.speed:
            return np.tile(self.place, (len(t), 1))
        step = np.minimum(t - self.t, self.speed / SLOWING)
        path = step - 0.5 * SLOWING * step**2 / self.speed
        return np.asarray(self.place + path[:, None] * self.velocity)

    def sd(self, t: Floats) -> Floats:
        """Give the standard errors of its places at times, s, in m."""
        if not self.speed:
            return np.full(len(t), self.sd_place)
        wait = np.abs(t - self.t)
        off = np.hypot(self.sd_speed * wait, 0.5 * SLOWING_SD * wait**2)
        return np.asarray(np.hypot(self.sd_place, off))


@dataclass(frozen=True)
class Gap:
    """A time in which a stone is out of sight, and how it goes at either end."""

    before: Way
    after: Way


def gaps(path: Trace, least: float = OUT_OF_SIGHT) -> Iterator[Gap]:
    """Give the times in which a stone is out of sight for longer than `least`, s."""
    for k in np.flatnonzero(np.diff(path.t) > least).tolist():
        if k + 1 >= FEWEST and len(path.t) - k - 1 >= FEWEST:
            yield Gap(last_way(path, k), first_way(path, k + 1))


def last_way(path: Trace, k: int) -> Way:
    """How a stone goes at its detection k, by those before."""
    few = np.flatnonzero(path.t[: k + 1] >= path.t[k] - WINDOW)
    return _way(path, np.arange(min(int(few[0]), max(k + 1 - FEWEST, 0)), k + 1), k)


def first_way(path: Trace, k: int) -> Way:
    """How a stone goes at its detection k, by those after."""
    few = np.flatnonzero(path.t[k:] <= path.t[k] + WINDOW) + k
    return _way(path, np.arange(k, min(max(int(few[-1]) + 1, k + FEWEST), len(path.t))), k)


def _way(path: Trace, samples: NDArray[np.int64], k: int) -> Way:
    """Fit a straight way to detections; its speed is that at detection k."""
    t, sd = path.t[samples], float(np.mean(path.sd[samples]))
    middle = float(t.mean())
    tau = t - middle
    spread = max(float(tau @ tau), 1e-12)
    velocity = tau @ path.xy[samples] / spread
    place, sd_speed = path.xy[samples].mean(axis=0), sd / float(np.sqrt(spread))
    speed = float(np.hypot(*velocity))
    sd_place = sd / float(np.sqrt(len(t)))
    if speed < STILL + 3 * sd_speed:
        return Way(float(path.t[k]), place, np.zeros(2), sd_place, sd_speed)
    ahead = float(path.t[k]) - middle
    velocity = velocity * max(1 - SLOWING * ahead / speed, 0.0)
    return Way(
        float(path.t[k]), place + ahead * velocity, velocity,
        float(np.hypot(sd_place, sd_speed * ahead)), sd_speed,
    )  # fmt: skip
