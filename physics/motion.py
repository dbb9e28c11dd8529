"""How a stone glides: friction of the ice, curl, and the path that follows from them.

Between two hits a stone's speed falls by the ice law alone, and the direction of its path
turns at a rate that depends on the speed and on the sense of the spin alone. So every glide
on one ice is a piece of one and the same curve, shifted, rotated and mirrored. `Curve` holds
that curve by the time that is left until rest; `Path` lays it through a stone's state. (A law
of curl that asks for the amount of the spin too would need a curve for every path.)
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from data.sheet import GRAVITY

Array = NDArray[np.float64]

REST_SPEED = 1e-9
"""Speed below which a stone is at rest, m/s: it would stop within the width of an atom."""


class IceLaw(Protocol):
    """How the ice slows a stone; laws are frozen dataclasses, hashable and alike by value."""

    def __hash__(self) -> int: ...

    def deceleration(self, speed: ArrayLike) -> Array:
        """Deceleration against the motion at `speed` > 0 (m/s), in m/s², positive."""
        ...


class Curl(Protocol):
    """How a stone's path turns and how its spin is lost; frozen like `IceLaw`."""

    def __hash__(self) -> int: ...

    def turn_rate(self, speed: ArrayLike) -> Array:
        """Return the turning of the path at `speed` > 0 for a counter-clockwise spin, rad/s.

        A clockwise stone turns as fast the other way, one without spin goes straight.
        """
        ...

    def spin_loss(self, speed: ArrayLike) -> Array:
        """Loss of |spin| at `speed` >= 0, rad/s², not negative."""
        ...


@dataclass(frozen=True)
class Constant:
    """Coulomb friction, a = μ g.

    Attributes
    ----------
    friction : float
        Coefficient μ; 0.0109 is what the study of the 2018 Olympic final found.
    """

    friction: float = 0.0109

    def deceleration(self, speed: ArrayLike) -> Array:
        """Deceleration μ g, m/s², of the shape of `speed`."""
        return np.full_like(np.asarray(speed, float), self.friction * GRAVITY)


@dataclass(frozen=True)
class FCV1:
    """Friction of the FCV1 model, μ(v) = a / (v + v_c) + b.

    Source: Uehara and Ito, 2021, the default of the simulator Digital Curling.

    Attributes
    ----------
    a, v_c, b : float
        Constants of the law: m/s, m/s and a pure number.
    gravity : float
        Free fall, m/s², as the simulator has it.
    """

    a: float = 0.00200985
    v_c: float = 0.06385782
    b: float = 0.00626286
    gravity: float = 9.807

    def deceleration(self, speed: ArrayLike) -> Array:
        """Deceleration μ(v) g, m/s²."""
        friction = self.a / (np.asarray(speed, float) + self.v_c) + self.b
        return np.asarray(friction * self.gravity)


@dataclass(frozen=True)
class Penner:
    """Friction that falls with the root of the speed, μ(v) = μ1 (v / 1 m/s)^(-1/2).

    Source: Penner, 2001, Am. J. Phys. 69, 332.

    Attributes
    ----------
    friction : float
        Coefficient at 1 m/s.
    """

    friction: float = 0.008

    def deceleration(self, speed: ArrayLike) -> Array:
        """Deceleration μ(v) g, m/s²; `speed` must be positive."""
        return np.asarray(self.friction * GRAVITY / np.sqrt(np.asarray(speed, float)))


@dataclass(frozen=True)
class NoCurl:
    """Straight paths; the spin is kept until the stone stops."""

    def turn_rate(self, speed: ArrayLike) -> Array:
        """Zero, rad/s."""
        return np.zeros_like(np.asarray(speed, float))

    def spin_loss(self, speed: ArrayLike) -> Array:
        """Zero, rad/s²."""
        return np.zeros_like(np.asarray(speed, float))


@dataclass(frozen=True)
class FCV1Curl:
    """Curl of the FCV1 model: a counter-clockwise stone curls to its left.

    dφ/dt = sign(ω) turn (v / 1 m/s)^(-0.8), dω/dt = -sign(ω) loss / max(v, slow).
    Source: Uehara and Ito, 2021, the default of the simulator Digital Curling.

    Attributes
    ----------
    turn : float
        Turning of the path at 1 m/s, rad/s.
    loss : float
        Loss of spin times speed, m rad/s³.
    slow : float
        Speed below which the loss of spin no longer grows, m/s.
    """

    turn: float = 0.00820
    loss: float = 0.025
    slow: float = 0.001

    def turn_rate(self, speed: ArrayLike) -> Array:
        """Return the turning of the path, rad/s; `speed` must be positive."""
        return np.asarray(self.turn * np.asarray(speed, float) ** -0.8)

    def spin_loss(self, speed: ArrayLike) -> Array:
        """Loss of |spin|, rad/s²."""
        return np.asarray(self.loss / np.maximum(np.asarray(speed, float), self.slow))


ICE_LAWS: tuple[str, ...] = ("constant", "fcv1", "penner")
CURL_LAWS: tuple[str, ...] = ("none", "fcv1")


def ice_law(name: str, friction: float | None = None) -> IceLaw:
    """Return the ice law of that name, one of `ICE_LAWS`.

    Parameters
    ----------
    name : str
        ``constant``, ``fcv1`` or ``penner``.
    friction : float, optional
        Coefficient for ``constant``, coefficient at 1 m/s for ``penner``.

    Raises
    ------
    ValueError
        Where there is no such law, or it has no coefficient to set.
    """
    if name == "constant":
        return Constant() if friction is None else Constant(friction)
    if name == "penner":
        return Penner() if friction is None else Penner(friction)
    if name != "fcv1":
        raise ValueError(f"no ice law {name!r}; there are {', '.join(ICE_LAWS)}")
    if friction is not None:
        raise ValueError("the ice law fcv1 has no friction to set")
    return FCV1()


def curl_law(name: str) -> Curl:
    """Return the law of curl of that name, one of `CURL_LAWS`; ValueError for another."""
    if name == "none":
        return NoCurl()
    if name == "fcv1":
        return FCV1Curl()
    raise ValueError(f"no law of curl {name!r}; there are {', '.join(CURL_LAWS)}")


class Motion(NamedTuple):
    """State of one stone: place (m), angle (rad), velocity (m/s), spin (rad/s)."""

    x: float
    y: float
    theta: float
    vx: float
    vy: float
    omega: float


class Point(NamedTuple):
    """Place (m), speed (m/s) and direction (rad) of a stone on its path."""

    x: float
    y: float
    speed: float
    heading: float


class _Cell(NamedTuple):
    """Cubics over one cell of a curve, in s = τ - τ_k, lowest power first."""

    speed: tuple[float, float, float, float]
    straight: tuple[float, float, float, float]
    turn: tuple[float, float, float, float]
    along: tuple[float, float, float, float]
    aside: tuple[float, float, float, float]
    loss: tuple[float, float, float, float]
    unwound: tuple[float, float, float, float]


def _cubic(c: tuple[float, float, float, float], s: float) -> float:
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]))


@dataclass(frozen=True, repr=False, eq=False)
class Curve:
    """The one curve of all glides, by the time τ that is left until rest.

    Attributes
    ----------
    tau : list of float
        Times of the nodes, s, from 0 upwards.
    speed, loss : list of float
        Speed (m/s) and spin lost from there to rest (rad/s) at the nodes.
    cells : list
        Cubics for speed; distance to rest along a straight path; turning to rest; distance
        to rest along the last direction and aside of it; spin lost; its integral over τ.
    """

    tau: list[float]
    speed: list[float]
    loss: list[float]
    cells: list[_Cell]

    def cell(self, tau: float) -> tuple[_Cell, float]:
        """Return the cell that holds `tau` and the time since its first node."""
        k = min(max(bisect_right(self.tau, tau) - 1, 0), len(self.cells) - 1)
        return self.cells[k], tau - self.tau[k]

    def tau_at_speed(self, speed: float) -> float:
        """Time until rest of a stone with that speed, s."""
        k = min(bisect_right(self.speed, speed), len(self.cells)) - 1
        return self.tau[k] + _solve(self.cells[k].speed, speed, self.tau[k + 1] - self.tau[k])

    def tau_at_loss(self, loss: float) -> float:
        """Time until rest from which on a stone loses that much spin, s."""
        k = min(bisect_right(self.loss, loss), len(self.cells)) - 1
        return self.tau[k] + _solve(self.cells[k].loss, loss, self.tau[k + 1] - self.tau[k])


def _solve(c: tuple[float, float, float, float], value: float, width: float) -> float:
    """Where in 0..width the rising cubic has that value: Newton's method in a bracket."""
    low, high = 0.0, width
    s = min(max((value - c[0]) / c[1], low), high) if c[1] > 0 else width / 2
    for _ in range(60):
        f = _cubic(c, s) - value
        if f > 0:
            high = s
        else:
            low = s
        slope = c[1] + s * (2 * c[2] + 3 * s * c[3])
        step = s - f / slope if slope > 0 else math.inf
        new = step if low <= step <= high else (low + high) / 2
        if abs(new - s) <= 1e-16 * width:
            return new
        s = new
    return s


@lru_cache(maxsize=16)
def curve(ice: IceLaw, curl: Curl, top: float, cells: int = 2048) -> Curve:
    """Integrate the curve of all glides up to a speed.

    Nodes lie evenly in v^(1/5), in which FCV1's curl, that grows as v^(-0.8) towards rest, is
    smooth; the integrals over each cell are taken by Gauss and Legendre's rule of five points.

    Parameters
    ----------
    ice, curl : IceLaw, Curl
        The laws; must be hashable.
    top : float
        Highest speed, m/s.
    cells : int
        Number of cells; the error of a place falls with its fourth power.
    """
    u = np.linspace(0.0, top**0.2, cells + 1)
    width = u[1]
    x = (np.polynomial.legendre.leggauss(5)[0] + 1) / 2
    powers = np.arange(1, len(x) + 1)
    basis = np.linalg.inv(np.vander(x, increasing=True))
    to_inner = (x[:, None] ** powers / powers) @ basis
    to_end = (1 / powers) @ basis

    def integral(rate: Array) -> tuple[Array, Array]:
        inner = width * rate @ to_inner.T
        nodes = np.concatenate([[0.0], np.cumsum(width * rate @ to_end)])
        return nodes[:-1, None] + inner, nodes

    inner_u = u[:-1, None] + width * x
    inner_v = inner_u**5
    dtau = 5 * inner_u**4 / ice.deceleration(inner_v)
    _, tau = integral(dtau)
    _, straight = integral(inner_v * dtau)
    inner_turn, turn = integral(curl.turn_rate(inner_v) * dtau)
    _, along = integral(inner_v * np.cos(inner_turn) * dtau)
    _, aside = integral(inner_v * np.sin(inner_turn) * dtau)
    inner_loss, loss = integral(curl.spin_loss(inner_v) * dtau)
    _, unwound = integral(inner_loss * dtau)

    v = u**5
    moving = v[1:]
    columns = (
        (v, ice.deceleration(moving)),
        (straight, moving),
        (turn, curl.turn_rate(moving)),
        (along, moving * np.cos(turn[1:])),
        (aside, moving * np.sin(turn[1:])),
        (loss, curl.spin_loss(moving)),
        (unwound, loss[1:]),
    )
    coefficients = np.stack([_hermite(tau, *column) for column in columns], axis=1)
    return Curve(
        tau.tolist(),
        v.tolist(),
        loss.tolist(),
        [_Cell(*map(tuple, cell)) for cell in coefficients.tolist()],
    )


def _hermite(tau: Array, value: Array, slope: Array) -> Array:
    """Coefficients of the cubics with those values and slopes, shape (cells, 4).

    The slope at rest, where laws may have a pole, is taken as that of the chord.
    """
    h = np.diff(tau)
    chord = np.diff(value) / h
    left = np.concatenate([chord[:1], slope[:-1]])
    right = slope
    return np.stack(
        [value[:-1], left, (3 * chord - 2 * left - right) / h, (left + right - 2 * chord) / h**2],
        axis=1,
    )


def _curve_for(ice: IceLaw, curl: Curl, speed: float) -> Curve:
    """Return a curve that reaches `speed`: one for all up to 4 m/s, others by doubling."""
    top = 4.0
    while top < speed:
        top *= 2
    return curve(ice, curl, top)


class _Arc(NamedTuple):
    """A piece of the curve, laid where it would end at rest."""

    x: float
    y: float
    heading: float
    cos: float
    sin: float
    sense: int

    def place(self, cell: _Cell, s: float) -> tuple[float, float]:
        """Place at `s` into a cell of the curve, m."""
        if not self.sense:
            way = _cubic(cell.straight, s)
            return self.x - self.cos * way, self.y - self.sin * way
        along, aside = _cubic(cell.along, s), self.sense * _cubic(cell.aside, s)
        return (
            self.x - self.cos * along - self.sin * aside,
            self.y - self.sin * along + self.cos * aside,
        )

    def direction(self, cell: _Cell, s: float) -> float:
        """Direction of the motion at `s` into a cell of the curve, rad."""
        return self.heading - self.sense * _cubic(cell.turn, s) if self.sense else self.heading


def _arc(x: float, y: float, heading: float, sense: int, cell: _Cell, s: float) -> _Arc:
    """Lay the curve through a place and a direction at `s` into a cell."""
    last = heading + sense * _cubic(cell.turn, s)
    through = _Arc(0.0, 0.0, last, math.cos(last), math.sin(last), sense)
    dx, dy = through.place(cell, s)
    return through._replace(x=x - dx, y=y - dy)


class Path:
    """The way of one stone from a state until it rests, if nothing hits it.

    As long as it spins the stone follows the curve, then goes straight; if it stops before its
    spin is gone, it turns on the spot until the law has taken the rest.

    Attributes
    ----------
    start, stop, rest : float
        Times at which it begins, at which the stone stops gliding and at which its spin
        has ended too, s.
    length : float
        Distance along the path from start to stop, m.
    """

    __slots__ = (
        "_arc", "_curve", "_loss", "_motion", "_pivot", "_sense", "_spin", "_straight", "_tau",
        "_tau_spin", "_theta", "_unwound", "length", "rest", "start", "stop",
    )  # fmt: skip

    def __init__(self, start: float, motion: Motion, ice: IceLaw, curl: Curl) -> None:
        """Lay the path through `motion` at the time `start`."""
        speed = math.hypot(motion.vx, motion.vy)
        if speed < REST_SPEED:
            motion = motion._replace(vx=0.0, vy=0.0)
            speed = 0.0
        self._motion = motion
        self._curve = _curve_for(ice, curl, speed)
        self._tau = tau = self._curve.tau_at_speed(speed) if speed else 0.0
        self.start, self.stop = start, start + tau
        cell, s = self._curve.cell(tau)
        self.length = _cubic(cell.straight, s)
        self._loss, self._unwound = _cubic(cell.loss, s), _cubic(cell.unwound, s)
        self._sense = sense = (motion.omega > 0) - (motion.omega < 0)
        heading = math.atan2(motion.vy, motion.vx)
        self._arc = _arc(motion.x, motion.y, heading, sense, cell, s)
        left = abs(motion.omega) - self._loss
        self._tau_spin = 0.0
        self._straight = self._arc
        if left < 0 and sense:
            self._tau_spin = self._curve.tau_at_loss(-left)
            cell, s = self._curve.cell(self._tau_spin)
            x, y = self._arc.place(cell, s)
            self._straight = _arc(x, y, self._arc.direction(cell, s), 0, cell, s)
        self._theta = self._turned(self._tau_spin)
        # A law that takes no spin leaves it to the stone until it stops.
        self._pivot = float(curl.spin_loss(0.0))
        self._spin = max(left, 0.0) if self._pivot > 0 else 0.0
        self.rest = self.stop + (self._spin / self._pivot if self._spin else 0.0)

    def at(self, t: float) -> Motion:
        """State at the time `t` >= start; where it rests, from then on."""
        if t <= self.start:
            return self._motion
        tau = self.stop - t
        if tau <= 0:
            since = min(-tau, self.rest - self.stop)
            omega = self._spin - self._pivot * since if t < self.rest else 0.0
            theta = self._theta + self._sense * (self._spin - self._pivot * since / 2) * since
            if self._tau == 0:
                x, y = self._motion.x, self._motion.y
            else:
                x, y = self._straight.x, self._straight.y
            return Motion(x, y, theta, 0.0, 0.0, self._sense * omega)
        cell, s = self._curve.cell(tau)
        spins = tau > self._tau_spin
        arc = self._arc if spins else self._straight
        x, y = arc.place(cell, s)
        heading, speed = arc.direction(cell, s), _cubic(cell.speed, s)
        omega = self._motion.omega
        theta = self._theta
        if self._sense and spins:
            omega += self._sense * (_cubic(cell.loss, s) - self._loss)
            theta = self._turned(tau)
        elif self._sense:
            omega = 0.0
        return Motion(x, y, theta, speed * math.cos(heading), speed * math.sin(heading), omega)

    def point(self, t: float) -> Point:
        """Place, speed and direction at the time `t` >= start; at rest the last direction."""
        tau = self.stop - t
        if tau <= 0:
            return Point(self._straight.x, self._straight.y, 0.0, self._straight.heading)
        cell, s = self._curve.cell(tau)
        arc = self._arc if tau > self._tau_spin else self._straight
        x, y = arc.place(cell, s)
        return Point(x, y, _cubic(cell.speed, s), arc.direction(cell, s))

    def _turned(self, tau: float) -> float:
        """Angle of the stone while it spins, `tau` before rest."""
        cell, s = self._curve.cell(tau)
        spin = self._motion.omega - self._sense * self._loss
        unwound = self._unwound - _cubic(cell.unwound, s)
        return self._motion.theta + spin * (self._tau - tau) + self._sense * unwound
