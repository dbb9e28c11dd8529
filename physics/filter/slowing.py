"""How a gliding stone slows: by a deceleration that is a power of the speed it has left.

With a(v) = a0 (v0 / v)^p the speed is v0 (1 - t / T)^(1 / (1 + p)), which ends at
T = v0 / ((1 + p) a0): p is 0 on ice of constant friction and 1/2 in Penner's law. Ice also turns
the path, the more so the slower the stone: its heading goes with the speed's power `BEND`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.estimates import Estimate

Floats = NDArray[np.float64]

LONGEST = 1e3
"""Speed over deceleration beyond which a stone is as good as not slowed, s."""

TINY = 1e-12
"""Share of a motion that counts as none left: its logarithm is still a number."""

V_C = 0.064
"""v_c in FCV1's μ(v) = a / (v + v_c) + b, m/s (Uehara and Ito, 2021): what part of the friction
fades with the speed does so as there."""

SHARE = Estimate(0.2, 0.3)
"""What is known beforehand of the share of the friction at 1 m/s that fades with the speed, of
curling stones: 0 on even ice, 0.23 in FCV1, in Penner's law 0.45 to 0.6."""

FORM_SD = 0.1
"""How much p differs from what FCV1's form has: Penner's law has 1/2 at all speeds, that form with
its share 0.3 at 2 m/s, 0.5 at 1 and 0.6 at 0.3."""

FIXED = 1e-4
"""How well a power that is not to be found is known."""

LEAST_LEFT = 0.2
"""Share of the friction at 1 m/s that is left at any speed, of ice that would slow slow stones
less: no such ice is known, but errors may make it seem so."""

BEND = 0.5
"""Power of the speed that the heading goes with: as it turns by v^(-0.8) a second (FCV1; Uehara and
Ito, 2021), 0.2 + p."""

NO_WAY = 1e-3
"""Speed below which a motion has no direction, m/s."""

LEAST, MOST = -0.5, 1.0
"""Bounds of p: past any law of ice."""


def more(speed: ArrayLike) -> Floats:
    """How much more than at 1 m/s the part of the friction is that fades with the speed.

    By FCV1 (Uehara and Ito, 2021), relative to what it is there.
    """
    return np.asarray((1 + V_C) / (np.asarray(speed, float) + V_C) - 1)


def at_speed(speed: ArrayLike, mean: float, share: float, sd_share: float) -> tuple[Floats, Floats]:
    """Deceleration at speeds, m/s², and its standard error by that of the share.

    Parameters
    ----------
    speed : array_like
        m/s.
    mean : float
        Deceleration at 1 m/s, m/s².
    share, sd_share : float
        Share of it that fades with the speed, and its standard error.
    """
    rise = more(speed)
    return mean * np.maximum(1 + share * rise, LEAST_LEFT), np.abs(mean * sd_share * rise)


def power_at(speed: ArrayLike, share: ArrayLike) -> Floats:
    """Power p with which a deceleration falls about a speed, m/s, if a share of it fades."""
    speed, share = np.asarray(speed, float), np.asarray(share, float)
    slope = (1 + V_C) * speed / (speed + V_C) ** 2
    return share * slope / (1 + share * more(speed))


def power_prior(speed: float, share: float, sd_share: float) -> tuple[float, float]:
    """Power p about a speed, m/s, and its standard error, if so much of a deceleration fades."""
    shares = np.clip([share, share - sd_share, share + sd_share], 0.0, 1.0)
    power, low, high = power_at(speed, shares).tolist()
    return power, float(np.hypot(0.5 * (high - low), FORM_SD)) if sd_share else FIXED


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


def _left(tau: Floats, c: float, q: float) -> tuple[Floats, Floats]:
    """Share of the time to the stop that is left, and of the speed."""
    left = np.maximum(1 - q / c * tau, TINY)
    return left, left ** (1 / q)


def _of_places(tau: Floats, c: float, q: float) -> Floats:
    """Tell what an acceleration at the origin does to places at times, shape (6, n).

    Factors on its part along the motion and on that across it, then their derivatives by
    `time_left`, then those by 1 + p.
    """
    left, share = _left(tau, c, q)
    turning = share ** (1 + BEND)
    # Integrals of the two over the time, and their derivatives by q.
    k, m = 1 / (q + 1), 1 / (q + 1 + BEND)
    one, more = c * k * (1 - left * share), c * m * (1 - left * turning)
    decay, over = c / q**2 * left * np.log(left), tau / q
    one_by_q = k * (decay * share - one) + over * share
    more_by_q = m * ((1 + BEND) * decay * turning - more) + over * turning
    along, across = c * (tau - one), c / BEND * (one - more)
    return np.array(
        [
            along,
            across,
            2 / c * along - tau * (1 - share),
            2 / c * across - tau / BEND * (share - turning),
            -c * one_by_q,
            c / BEND * (one_by_q - more_by_q),
        ]
    )


def _of_velocities(tau: Floats, c: float, q: float) -> Floats:
    """Tell what it does to velocities: as `_of_places`."""
    left, share = _left(tau, c, q)
    turned = share**BEND
    along, across = c * (1 - share), c / BEND * share * (1 - turned)
    now, aside = _of_changes(tau, c, q)
    less = -share * (np.log(left) / q + tau / (c * left)) / q
    return np.array(
        [
            along,
            across,
            (along - tau * now) / c,
            (across - tau * aside) / c,
            -c * less,
            c / BEND * less * (1 - (1 + BEND) * turned),
        ]
    )


def _of_changes(tau: Floats, c: float, q: float) -> tuple[Floats, Floats]:
    """Factors on the acceleration at the origin, along and across, that give it at some times."""
    left, share = _left(tau, c, q)
    now = share / left
    return now, ((1 + BEND) * share**BEND - 1) / BEND * now


def _across(x: Floats) -> tuple[Floats, Floats]:
    """Part of the acceleration across the motion, and its derivatives by it all, shape (2, 6)."""
    # A few numbers: arrays of two would take four times as long, a tenth of the time to find hits.
    (_, vx, ax), (_, vy, ay) = x.tolist()
    square = vx * vx + vy * vy
    if square < NO_WAY**2:
        return np.zeros(2), np.zeros((2, 6))
    ux, uy, along = vx / square, vy / square, (vx * ax + vy * ay) / square
    bx, by = ax - 2 * along * vx, ay - 2 * along * vy
    slopes = [
        [0.0, -along - ux * bx, 1 - ux * vx, 0.0, -ux * by, -ux * vy],
        [0.0, -uy * bx, -uy * vx, 0.0, -along - uy * by, 1 - uy * vy],
    ]
    return np.array([ax - along * vx, ay - along * vy]), np.array(slopes)


def _bent(x: Floats, reach: Floats, c: float) -> tuple[Floats, Floats]:
    """Tell what an acceleration does, shape (n, 2), and its derivatives by the motion and p.

    ``reach`` is that of `_of_places` or `_of_velocities`.
    """
    aside, by_aside = _across(x)
    ways = np.array([x[:, 2] - aside, aside])
    by_motion = _by_motion(x, c)
    rows = np.zeros((6, 2, 7))
    rows[0, [0, 1], [2, 5]] = 1.0
    rows[0, :, :6] -= by_aside
    rows[1, :, :6] = by_aside
    rows[2:4, :, :6] = ways[:, :, None] * by_motion
    rows[4:, :, 6] = ways
    return reach[:2].T @ ways, (reach.T @ rows.reshape(6, 14)).reshape(-1, 2, 7)


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
    bent, slopes = _bent(x, _of_places(tau, c, q), c)
    for axis in range(2):
        slopes[:, axis, 3 * axis] += 1.0
        slopes[:, axis, 3 * axis + 1] += tau
    return x[:, 0] + tau[:, None] * x[:, 1] + bent, slopes


@dataclass(frozen=True)
class MotionState:
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


def motion_state(x: Floats, tau: float, power: float) -> MotionState:
    """Return what `course` says of one time, and the like of the velocity."""
    times = np.array([tau])
    place, by_place = course(x, times, power)
    c, q = time_left(x), 1 + power
    if q * tau >= c:
        return MotionState(place[0], np.zeros(2), np.zeros(2), by_place[0], np.zeros((2, 7)))
    bent, by_speed = _bent(x, _of_velocities(times, c, q), c)
    for axis in range(2):
        by_speed[:, axis, 3 * axis + 1] += 1.0
    now, aside = _of_changes(times, c, q)
    across = _across(x)[0]
    change = now * (x[:, 2] - across) + aside * across
    return MotionState(place[0], x[:, 1] + bent[0], change, by_place[0], by_speed[0])


def motion(x: Floats, tau: float, power: float) -> tuple[Floats, Floats]:
    """Place and velocity at one time; parameters are those of `course`."""
    c, q = time_left(x), 1 + power
    times = np.minimum([tau], c / q)
    bent = _of_places(times, c, q)[:2, 0] @ _ways(x)
    return x[:, 0] + times[0] * x[:, 1] + bent, velocities(x, np.array([tau]), power)[0]


def velocities(x: Floats, tau: Floats, power: float) -> Floats:
    """Velocities at times, shape (n, 2), m/s; parameters are those of `course`."""
    c, q = time_left(x), 1 + power
    going = x[:, 1] + _of_velocities(np.minimum(tau, c / q), c, q)[:2].T @ _ways(x)
    # At its stop a stone has no velocity across either.
    return np.where(q * tau[:, None] < c, going, 0.0)


def _ways(x: Floats) -> Floats:
    """Acceleration at the origin along the motion and across it, shape (2, 2)."""
    aside = _across(x)[0]
    return np.array([x[:, 2] - aside, aside])


def change_by(tau: float, x: Floats, power: float, way: Floats) -> Floats:
    """Factors on the acceleration at the origin, by axis, that give it at a time in a direction."""
    now, aside = _of_changes(np.array([tau]), time_left(x), 1 + power)
    square = float(x[:, 1] @ x[:, 1])
    along = x[:, 1] * (x[:, 1] @ way) / square if square > NO_WAY**2 else way
    return np.asarray(now * along + aside * (way - along))
