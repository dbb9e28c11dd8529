"""How a gliding stone slows: by a deceleration that is a power of the speed it has left.

With a(v) = a0 (v0 / v)^p the speed is v0 (1 - t / T)^(1 / (1 + p)), which ends at
T = v0 / ((1 + p) a0): p is 0 on ice of constant friction and 1/2 in Penner's law.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import ArrayLike, NDArray

from data.results import Estimate

Floats = NDArray[np.float64]

LONGEST = 1e3
"""Speed over deceleration beyond which a stone is as good as not slowed, s."""

TINY = 1e-12
"""Share of a motion that counts as none left: its logarithm is still a number."""

SLOWEST = 0.06
"""Speed below which a stone is slowed as there, m/s: as by FCV1 (Uehara and Ito, 2021)."""

FALL = Estimate(0.25, 0.2)
"""What is known of p beforehand for curling stones: 0 on even ice, 1/2 in Penner's law, between in
FCV1's."""

LEAST, MOST = -0.5, 1.0
"""Bounds of p: past any law of ice."""


def at_speed(speed: ArrayLike, mean: float, power: float, sd_power: float) -> tuple[Floats, Floats]:
    """Deceleration at speeds, m/s², and its standard error by that of the power.

    Parameters
    ----------
    speed : array_like
        m/s.
    mean : float
        Deceleration at 1 m/s, m/s².
    power, sd_power : float
        p and its standard error.
    """
    log = np.log(np.maximum(speed, SLOWEST))
    value = np.asarray(mean * np.exp(-power * log))
    return value, np.abs(sd_power * value * log)


def time_left(x: Floats) -> float:
    """Speed over deceleration at the origin of a motion, s; `LONGEST` where it does not slow.

    Parameters
    ----------
    x : (2, 3) array
        Place, velocity and acceleration at the origin, on either axis.
    """
    (_, vx, ax), (_, vy, ay) = x.tolist()
    square, braking = vx * vx + vy * vy, -vx * ax - vy * ay
    return float(square / braking) if LONGEST * braking > square else LONGEST


def _by_motion(x: Floats, c: float) -> Floats:
    """Differentiate `time_left` by a motion, shape (6,)."""
    out = np.zeros((2, 3))
    if c < LONGEST:
        braking = -float(x[:, 1] @ x[:, 2])
        out[:, 1] = (2 * x[:, 1] + c * x[:, 2]) / braking
        out[:, 2] = c * x[:, 1] / braking
    return out.ravel()


def stop_after(x: Floats, power: float) -> float:
    """Time from its origin until a motion ends, s; parameters are those of `course`."""
    return time_left(x) / (1 + power)


def speed_left(x: Floats, tau: float, power: float) -> float:
    """Share of its speed at the origin that slowing leaves; parameters are those of `course`."""
    q = 1 + power
    return float(max(1 - q * tau / time_left(x), 0.0) ** (1 / q))


def course(x: Floats, tau: Floats, power: float) -> tuple[Floats, Floats]:
    """Places at times from the origin, and how they depend on the motion there.

    Parameters
    ----------
    x : (2, 3) array
        Place, velocity and acceleration at the origin, on either axis.
    tau : (n,) array
        Times from the origin, s; from the stop on a stone stays where it is.
    power : float
        p.

    Returns
    -------
    places : (n, 2) array
        m.
    slopes : (n, 2, 7) array
        Derivatives by what is in `x`, row by row, and by p.
    """
    c, q = time_left(x), 1 + power
    # The velocity vanishes at the stop, so that its own shift is of second order.
    tau = np.minimum(tau, c / q)
    left = np.maximum(1 - q / c * tau, TINY)
    speed, whole = left ** (1 / q), c * c / (q + 1)
    way = speed * left  # that is left of all from the origin
    bent = c * tau - whole * (1 - way)
    by_c = tau * (1 + speed) - 2 * whole / c * (1 - way)
    by_power = whole / (q + 1) * (1 - way) - whole / q**2 * way * np.log(left) - c / q * tau * speed
    slopes = np.zeros((len(tau), 2, 7))
    slopes[:, :, :6] = by_c[:, None, None] * np.outer(x[:, 2], _by_motion(x, c))
    for axis in range(2):
        slopes[:, axis, 3 * axis] += 1.0
        slopes[:, axis, 3 * axis + 1] += tau
        slopes[:, axis, 3 * axis + 2] += bent
    slopes[:, :, 6] = by_power[:, None] * x[:, 2]
    return x[:, 0] + tau[:, None] * x[:, 1] + bent[:, None] * x[:, 2], slopes


@dataclass(frozen=True)
class Moment:
    """A motion at one time.

    Attributes
    ----------
    place, speed, change : (2,) array
        m, m/s and m/s².
    by_place, by_speed : (2, 7) array
        Derivatives of the first two by what is in x, row by row, and by p.
    """

    place: Floats
    speed: Floats
    change: Floats
    by_place: Floats
    by_speed: Floats


def moment(x: Floats, tau: float, power: float) -> Moment:
    """Return what `course` says of one time, and the like of the velocity."""
    place, by_place = course(x, np.array([tau]), power)
    c, q = time_left(x), 1 + power
    left = 1 - q * tau / c
    by_speed = np.zeros((2, 7))
    if left <= 0:
        return Moment(place[0], np.zeros(2), np.zeros(2), by_place[0], by_speed)
    share = left ** (1 / q)
    by_c = 1 - share - tau * share / left / c
    by_speed[:, :6] = by_c * np.outer(x[:, 2], _by_motion(x, c))
    for axis in range(2):
        by_speed[axis, 3 * axis + 1] += 1.0
        by_speed[axis, 3 * axis + 2] += c * (1 - share)
    by_speed[:, 6] = (c * share * log(left) / q**2 + tau * share / left / q) * x[:, 2]
    now = motion(x, tau, power)
    return Moment(now[0], now[1], share / left * x[:, 2], by_place[0], by_speed)


def motion(x: Floats, tau: float, power: float) -> tuple[Floats, Floats]:
    """Place and velocity at one time; parameters are those of `course`."""
    c, q = time_left(x), 1 + power
    tau = min(tau, c / q)
    left = max(1 - q * tau / c, 0.0)
    speed = left ** (1 / q)
    bent = c * tau - c * c / (q + 1) * (1 - speed * left)
    # At its stop a stone has no velocity across either.
    going = x[:, 1] + c * (1 - speed) * x[:, 2] if left > 0 else np.zeros(2)
    return x[:, 0] + tau * x[:, 1] + bent * x[:, 2], going
