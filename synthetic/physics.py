"""Stones on ice by small steps: the independent truth behind the rendered clips.

Nothing here is shared with the library. Time goes on in steps of 0.1 ms; friction acts along
the motion, a contact is refined inside its step, and the impact is Coulomb's with a
restitution along the normal.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
GRAVITY = 9.81
RADIUS = 0.1455


@dataclass(frozen=True)
class Ice:
    """Friction μ(v) = a / (v + v_c) + b, path curl rate c v^(-p) and spin decay.

    Attributes
    ----------
    b, a, v_c : float
        Friction; constant μ = b where a = 0. a and v_c in m/s.
    curl, curl_power : float
        Turn of the path towards the side of the spin, rad/s at 1 m/s, and its fall with speed.
    spin_decay, spin_decay_at_rest : float
        Loss of spin, rad/s², while the stone moves and once it stands.
    """

    b: float = 0.0109
    a: float = 0.0
    v_c: float = 0.06
    curl: float = 0.0
    curl_power: float = 0.8
    spin_decay: float = 0.02
    spin_decay_at_rest: float = 1.0

    def friction(self, speed: float) -> float:
        """Coefficient μ at a speed in m/s."""
        return self.b + (self.a / (speed + self.v_c) if self.a else 0.0)


@dataclass(frozen=True)
class Impact:
    """Restitution, friction between stones, k in I = k m R², and the radius of contact, m."""

    restitution: float = 0.8345
    stone_friction: float = 0.05
    inertia: float = 0.5
    radius: float = RADIUS


@dataclass(frozen=True)
class Start:
    """State of one stone at time 0: m, m/s, rad, rad/s."""

    x: float
    y: float
    vx: float = 0.0
    vy: float = 0.0
    theta: float = 0.0
    omega: float = 0.0


@dataclass(frozen=True)
class Hit:
    """One impact; `first` is the faster stone, `normal` points from it to `second`.

    `before` and `after` hold (vx, vy, omega) of both stones.
    """

    t: float
    first: int
    second: int
    normal: tuple[float, float]
    before: tuple[tuple[float, float, float], tuple[float, float, float]]
    after: tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Motion:
    """Sampled motion: times (n,), states (n, stones, 6) as x, y, theta, vx, vy, omega.

    At a hit two samples share a time, the states before and after.
    """

    times: Array
    states: Array
    hits: tuple[Hit, ...]

    def at(self, t: ArrayLike) -> Array:
        """States at times t (s), shape (..., stones, 6); the state after a hit at its instant.

        Before the first time stones move as they do at it: its exposure begins before it.
        """
        moment = np.asarray(t, float)
        after = np.clip(np.searchsorted(self.times, moment, side="right"), 1, len(self.times) - 1)
        t0, t1 = self.times[after - 1], self.times[after]
        span = np.where(t1 > t0, t1 - t0, 1.0)
        w = np.minimum((moment - t0) / span, 1)[..., None, None]
        return np.asarray((1 - w) * self.states[after - 1] + w * self.states[after])


def collide(
    first: Sequence[float], second: Sequence[float], normal: tuple[float, float], impact: Impact
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Velocities and spins (vx, vy, omega) after an impact of two equal stones.

    Parameters
    ----------
    first, second : sequence of float
        (vx, vy, omega) before, m/s and rad/s.
    normal : tuple of float
        Unit vector from the first stone to the second.
    impact : Impact
        Restitution and friction at the contact.
    """
    nx, ny = normal
    tx, ty = -ny, nx
    dvx, dvy = first[0] - second[0], first[1] - second[1]
    closing = dvx * nx + dvy * ny
    slip = dvx * tx + dvy * ty + impact.radius * (first[2] + second[2])
    push = 0.5 * (1 + impact.restitution) * closing
    grip = -slip / (2 * (1 + 1 / impact.inertia))
    most = impact.stone_friction * push
    rub = max(-most, min(most, grip))
    turn = rub / (impact.inertia * impact.radius)
    px, py = -push * nx + rub * tx, -push * ny + rub * ty
    return (
        (first[0] + px, first[1] + py, first[2] + turn),
        (second[0] - px, second[1] - py, second[2] + turn),
    )


def _advance(s: list[float], ice: Ice, dt: float) -> None:
    x, y, theta, vx, vy, omega = s
    speed = math.hypot(vx, vy)
    if speed == 0.0 and omega == 0.0:
        return
    loss = ice.spin_decay_at_rest
    if speed > 0.0:
        loss = ice.spin_decay
        slower = speed - GRAVITY * ice.friction(speed) * dt
        travel = 0.5 * (speed + slower) * dt
        if slower <= 0:
            travel, slower = speed * speed / (2 * GRAVITY * ice.friction(speed)), 0.0
        if ice.curl and omega:
            heading = math.atan2(vy, vx)
            rate = ice.curl * max(speed, 0.01) ** -ice.curl_power
            bend = math.copysign(rate * dt, omega)
            s[0] = x + travel * math.cos(heading + bend / 2)
            s[1] = y + travel * math.sin(heading + bend / 2)
            s[3] = slower * math.cos(heading + bend)
            s[4] = slower * math.sin(heading + bend)
        else:
            s[0] = x + travel * vx / speed
            s[1] = y + travel * vy / speed
            s[3] = slower * vx / speed
            s[4] = slower * vy / speed
    spin = math.copysign(max(abs(omega) - loss * dt, 0.0), omega)
    s[2] = theta + 0.5 * (omega + spin) * dt
    s[5] = spin


def simulate(
    starts: Sequence[Start],
    duration: float,
    *,
    ice: Ice | None = None,
    impact: Impact | None = None,
    step: float = 1e-4,
    keep_every: int = 10,
) -> Motion:
    """Move all stones for `duration` seconds.

    Parameters
    ----------
    starts : sequence of Start
        States at time 0; no two stones may overlap.
    duration : float
        Length of time, s.
    ice, impact : Ice, Impact
        The laws; the defaults of the classes where left out.
    step : float
        Time step, s.
    keep_every : int
        One state is kept in so many steps.
    """
    ice, impact = ice or Ice(), impact or Impact()
    now = [[s.x, s.y, s.theta, s.vx, s.vy, s.omega] for s in starts]
    reach = 2 * impact.radius
    times, states, hits = [0.0], [[list(s) for s in now]], []

    def keep(t: float) -> None:
        times.append(t)
        states.append([list(s) for s in now])

    for k in range(1, math.ceil(duration / step) + 1):
        t = k * step
        moving = [i for i, s in enumerate(now) if s[3] or s[4]]
        for s in now:
            if s[3] or s[4] or s[5]:
                _advance(s, ice, step)
        for i in moving:
            for j in range(len(now)):
                if j == i or (j < i and j in moving):
                    continue
                a, b = now[i], now[j]
                dx = b[0] - a[0]
                if dx >= reach or dx <= -reach:
                    continue
                dy = b[1] - a[1]
                if dx * dx + dy * dy >= reach * reach:
                    continue
                gap = math.hypot(dx, dy)
                nx, ny = dx / gap, dy / gap
                closing = (a[3] - b[3]) * nx + (a[4] - b[4]) * ny
                if closing <= 0:
                    continue
                late = min((reach - gap) / closing, step)
                if math.hypot(b[3], b[4]) > math.hypot(a[3], a[4]):
                    i_first, i_second = j, i
                else:
                    i_first, i_second = i, j
                p, q = now[i_first], now[i_second]
                for s in (p, q):
                    s[0] -= s[3] * late
                    s[1] -= s[4] * late
                gap = math.hypot(q[0] - p[0], q[1] - p[1])
                nx, ny = (q[0] - p[0]) / gap, (q[1] - p[1]) / gap
                before = ((p[3], p[4], p[5]), (q[3], q[4], q[5]))
                after = collide(before[0], before[1], (nx, ny), impact)
                keep(t - late)
                p[3:], q[3:] = after[0], after[1]
                keep(t - late)
                hits.append(Hit(t - late, i_first, i_second, (nx, ny), before, after))
                for s in (p, q):
                    s[0] += s[3] * late
                    s[1] += s[4] * late
        if k % keep_every == 0:
            keep(t)
    return Motion(np.array(times), np.array(states), tuple(hits))
