"""Input and process model of the filter: one stone between two hits.

Place and rate make a pair on each axis: x with vx, y with vy, θ with ω. The pairs are independent,
and x and y have the same model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.slowing import at_speed
from curlshot.physics.filter.spin_end import SHARPEST, spin_ends

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

START_SD = (3.0, 10.0)
"""What is known of speed (m/s) and spin (rad/s) before the first detection."""

JUMP_SD = (1.0, 3.0)
"""How much velocity (m/s) and spin (rad/s) change where a motion changes without a hit, per change
of the rough velocity (m/s): a push of Δv that rubs turns a stone by up to μ Δv / (k R)."""

LEAST_JUMP = 0.02
"""Of the rough velocity, m/s."""

ENDED_SD = 1.0
"""How much a spin changes that ends at once as its stone comes to rest, rad/s."""

STILL_SD = (1e-3, 1e-3)
"""How still a stone at rest lies, m/s and rad/s."""

STOPPED_SD = 0.01
"""How well a stone is known to have stopped, m/s: the moment of it is not exactly known."""

ANYWHERE_SD = (10.0, 100.0)
"""What is known of place (m) and angle (rad) before the first detection, and once moved unseen."""

MEMORY = 0.125
"""Time over which what the ice takes keeps its deviation from the mean, s. Stones curl, and so it
never fades altogether; a longer time follows the errors of detections instead."""

PLACE_MEMORY, ANGLE_MEMORY = 0.3, 0.8
"""Times over which errors of detections that last for a while become others, s."""

LOSS_SD, MOST_LOSS_SD = (0.003, 0.015), (0.1, 1.0)
"""How much a slow stone loses speed (m/s²) and spin (rad/s²) otherwise than is known: times its
speed, m/s, and at most. It is slowed more, and loses its spin faster (FCV1: 0.02 / (v + 0.06) and
0.025 / v). Of both little is left open here: what all glides share has an error of its own
(`Model`)."""

SPIN_LOSS = SPIN_LOSS_SD = 0.0125
"""What is known beforehand of how much spin a stone loses, rad/s², times its speed, m/s: half of
what FCV1 has (Uehara and Ito, 2021), perhaps all of that or none."""

GATE = 100.0
"""Squared normalised innovation beyond which a detection is refused."""

PATIENCE = 2
"""Refusals in a row after which the filter is taken to be wrong, and detections to be right."""


class Gate:
    """Lets in detections whose normalised innovation is small, or after many refusals."""

    def __init__(self) -> None:
        self._refused = 0

    def passes(self, distance: float) -> bool:
        """Whether a detection is used, by its squared normalised innovation."""
        passes = distance < GATE or self._refused >= PATIENCE
        self._refused = 0 if passes else self._refused + 1
        return passes


@dataclass(frozen=True)
class Model:
    """How one stone's speed is expected to change.

    ``a`` is the deceleration at 1 m/s (m/s²), ``spread`` its deviation; at other speeds it goes
    as FCV1 has it if a ``share`` ± ``sd_share`` of it fades. The ice takes ``spin_loss`` ±
    ``sd_spin_loss`` of spin (rad/s²), times the speed (m/s).
    """

    a: float
    spread: float
    share: float = 0.0
    sd_share: float = 0.0
    spin_loss: float = SPIN_LOSS
    sd_spin_loss: float = SPIN_LOSS_SD


@dataclass(frozen=True)
class Stretch:
    """One stone between two hits, at n times; it is seen at one of them at least.

    Attributes
    ----------
    t : (n,) array
        Times, s, increasing.
    z : (n, 3) array
        x, y (m) and θ (rad); NaN where not seen.
    sd, slow : (n, 3) array
        Standard deviations of what is anew in each detection and of what lasts for a while.
    piece : (n,) array
        Number of the piece of its path: where it changes, the motion changed of itself.
    rest, idle : (n,) array of bool
        Whether the stone rests, and whether it also does not spin.
    speed : (n, 2) array
        About how fast it moves, m/s: for the way in which the ice slows it, how much its motion
        changes of itself, and how fast it may lose its spin.
    model : Model
    """

    t: Floats
    z: Floats
    sd: Floats
    slow: Floats
    piece: NDArray[np.int64]
    rest: Bools
    idle: Bools
    speed: Floats
    model: Model

    @property
    def moved(self) -> Bools:
        """Whether, in each of n - 1 steps, the stone was moved unseen from where it lay."""
        return np.asarray(self.rest[:-1] & self.rest[1:] & (np.diff(self.piece) != 0))

    @property
    def start(self) -> tuple[Floats, Floats]:
        """Places and angle to start from, and the standard deviations of the rates."""
        first = int(np.isfinite(self.z[:, 0]).argmax())
        angles = self.z[np.isfinite(self.z[:, 2]), 2]
        theta = float(angles[0]) if len(angles) else 0.0
        rates = np.where([self.rest[0], self.idle[0]], STILL_SD, START_SD)
        return np.array([*self.z[first, :2], theta]), rates[[0, 0, 1]]


Smoothed = tuple[Floats, Floats, NDArray[np.int64]]
"""x, y, vx, vy, θ, ω, shape (n, 6); their standard deviations; whether each detection was used."""

Filter = Callable[[Stretch], Smoothed]
"""Filters a stretch and smooths it backwards."""


@dataclass(frozen=True)
class Steps:
    """State transitions of a pair from each time to the next, n − 1 steps.

    place' = place + ``reach`` rate and rate' = ``keep`` rate, with noise of variance ``q00`` of
    the place and ``q11`` of the rate and covariance ``q01``; the error that lasts falls by
    ``fade`` and is renewed to its standard deviation. All of shape (n − 1,).
    """

    reach: Floats
    keep: Floats
    q00: Floats
    q01: Floats
    q11: Floats
    fade: Floats


def steps(stretch: Stretch) -> tuple[Steps, Steps]:
    """State transitions of x or y, and those of the angle."""
    rest, idle = stretch.rest, stretch.idle
    speed = np.maximum(np.hypot(stretch.speed[:-1, 0], stretch.speed[:-1, 1]), 1e-6)
    slower, turning = np.minimum(np.divide.outer(LOSS_SD, speed).T, MOST_LOSS_SD).T
    pivoting = np.where(rest[1:], MOST_LOSS_SD[1], turning)
    model = stretch.model
    unsure = at_speed(speed, model.a, model.share, model.sd_share)[1]
    deviation = np.sqrt(model.spread**2 + slower**2 + unsure**2)
    ends = spin_ends(stretch.t, stretch.z[:, 2], stretch.sd[:, 2], rest)
    still = np.zeros(len(ends))
    along = _steps(stretch, rest, deviation, still, 0)
    return along, _steps(stretch, idle, pivoting, np.where(ends, ENDED_SD, still), 1)


def _steps(stretch: Stretch, still: Bools, deviation: Floats, sudden: Floats, kind: int) -> Steps:
    """State transitions of a place (`kind` 0) or of the angle (1).

    ``deviation`` is of its acceleration, ``sudden`` of what else its rate changes by at once.
    """
    dt = np.diff(stretch.t)
    was, ends = still[:-1], still[1:]
    density = deviation**2 * MEMORY
    change = np.hypot(*np.diff(stretch.speed, axis=0).T) + LEAST_JUMP
    jump = np.where(np.diff(stretch.piece) != 0, JUMP_SD[kind] * change, sudden)
    jump = np.where(was, START_SD[kind], jump) ** 2  # at any moment of the step
    stopped = np.where(stretch.idle[1:], STILL_SD[kind], STOPPED_SD)
    # What was left of a motion ends somewhere in the step, be it stopped dead in full run.
    stop = np.where(was, 0.0, jump) * dt**2 / 12
    # Where it lay before, and how it faced, say nothing of that once it was moved.
    stop = np.where(stretch.moved, ANYWHERE_SD[kind] ** 2, stop)
    return Steps(
        reach=np.where(ends, np.where(was, 0.0, 0.5 * dt), dt),
        keep=np.where(ends, 0.0, 1.0),
        q00=np.where(ends, stop, density * dt**3 / 3 + jump * dt**2 / 3),
        q01=np.where(ends, 0.0, density * dt**2 / 2 + jump * dt / 2),
        q11=np.where(ends, stopped**2, density * dt + jump),
        fade=np.exp(-dt / (PLACE_MEMORY, ANGLE_MEMORY)[kind]),
    )


def drift(stretch: Stretch, along: Steps, turning: Steps) -> Floats:
    """Known change of the state by the ice since the first time, shape (n, 6).

    It is taken out of the detections before the filter and put back afterwards.
    """
    dt = np.diff(stretch.t)[:, None]
    speed = stretch.speed[:-1]
    size = np.hypot(speed[:, 0], speed[:, 1])[:, None]
    model = stretch.model
    loss = np.minimum(at_speed(size, model.a, model.share, model.sd_share)[0], size / dt)
    slowing = np.where(size < 1e-6, 0.0, -loss * speed / np.maximum(size, 1e-6))
    slowing[stretch.rest[1:]] = 0.0
    out = np.zeros((len(stretch.t), 6))
    x, y, vx, vy = 0.0, 0.0, 0.0, 0.0
    each = (stretch.t[1:] - stretch.t[:-1], along.reach, along.keep, *slowing.T)
    for k, (step, reach, keep, ax, ay) in enumerate(
        zip(*(values.tolist() for values in each), strict=True), 1
    ):
        x, y = x + reach * vx + 0.5 * step * step * ax, y + reach * vy + 0.5 * step * step * ay
        vx, vy = keep * vx + step * ax, keep * vy + step * ay
        out[k, :4] = x, y, vx, vy
    out[:, 4:] = _spin_lost(stretch, size[:, 0], turning)
    return out


def loss_rate(loss: float, speed: Floats) -> Floats:
    """How much spin stones of these speeds lose, rad/s², by the loss times the speed."""
    return np.minimum(loss / np.maximum(speed, 1e-6), MOST_LOSS_SD[1])


def loss_error(stretch: Stretch) -> Floats:
    """Change of angle and spin since the first time by one standard error of the loss, (n, 2)."""
    speed, turning = np.hypot(*stretch.speed[:-1].T), steps(stretch)[1]
    model = stretch.model
    more = replace(model, spin_loss=model.spin_loss + model.sd_spin_loss)
    return _spin_lost(replace(stretch, model=more), speed, turning) - _spin_lost(
        stretch, speed, turning
    )


def _spin_lost(stretch: Stretch, speed: Floats, turning: Steps) -> Floats:
    """Known change of angle and spin since the first time, shape (n, 2)."""
    out = np.zeros((len(stretch.t), 2))
    told = np.flatnonzero(np.isfinite(stretch.z[:, 2]) & ~stretch.rest)
    if len(told) < 2:
        return out
    sd = np.hypot(stretch.sd[told, 2], stretch.slow[told, 2])
    weight = 1 / np.maximum(sd, SHARPEST)
    spin = float(np.polyfit(stretch.t[told], stretch.z[told, 2], 1, w=weight)[0])
    loss = loss_rate(stretch.model.spin_loss, speed)
    loss[stretch.rest[1:]] = 0.0
    theta, omega = 0.0, 0.0
    each = (np.diff(stretch.t), turning.reach, turning.keep, loss)
    for k, (step, reach, keep, less) in enumerate(
        zip(*(values.tolist() for values in each), strict=True), 1
    ):
        after = max(keep * omega - step * less, -abs(spin))
        theta, omega = theta + 0.5 * reach * (omega + after), after
        out[k] = theta, omega
    return np.asarray(np.copysign(1.0, spin) * out)
