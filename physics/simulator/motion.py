"""How a stone glides: from a state to rest along the curve of its ice."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.curl import Curl
from curlshot.physics.ice import IceLaw
from curlshot.physics.simulator.curve import Cell, cubic, curve_for

Array = NDArray[np.float64]

REST_SPEED = 1e-9
"""Speed below which a stone is at rest, m/s: it would stop within the width of an atom."""


_new = tuple.__new__
"""Makes a named tuple in a third of the time that its own call takes."""


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


class _Arc(NamedTuple):
    """A piece of the curve, laid where it would end at rest."""

    x: float
    y: float
    heading: float
    cos: float
    sin: float
    sense: int

    def place(self, cell: Cell, s: float) -> tuple[float, float]:
        """Place at `s` into a cell of the curve, m."""
        if not self.sense:
            way = cubic(cell.straight, s)
            return self.x - self.cos * way, self.y - self.sin * way
        along, aside = cubic(cell.along, s), self.sense * cubic(cell.aside, s)
        return (
            self.x - self.cos * along - self.sin * aside,
            self.y - self.sin * along + self.cos * aside,
        )

    def direction(self, cell: Cell, s: float) -> float:
        """Direction of the motion at `s` into a cell of the curve, rad."""
        return self.heading - self.sense * cubic(cell.turn, s) if self.sense else self.heading


def _arc(x: float, y: float, heading: float, sense: int, cell: Cell, s: float) -> _Arc:
    """Lay the curve through a place and a direction at `s` into a cell."""
    if not sense:
        cos, sin, way = math.cos(heading), math.sin(heading), cubic(cell.straight, s)
        return _Arc(x + cos * way, y + sin * way, heading, cos, sin, 0)
    last = heading + sense * cubic(cell.turn, s)
    cos, sin = math.cos(last), math.sin(last)
    along, aside = cubic(cell.along, s), sense * cubic(cell.aside, s)
    return _Arc(x + cos * along + sin * aside, y + sin * along - cos * aside, last, cos, sin, sense)


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
    end : Point
        Where it stops.
    change : float
        Bound on the change of its velocity in a time, m/s².
    """

    __slots__ = (
        "_arc", "_curve", "_loss", "_motion", "_pivot", "_sense", "_spin", "_straight", "_tau",
        "_tau_spin", "_unwound", "change", "end", "length", "rest", "start", "stop",
    )  # fmt: skip

    def __init__(self, start: float, motion: Motion, ice: IceLaw, curl: Curl) -> None:
        """Lay the path through `motion` at the time `start`."""
        speed = math.hypot(motion.vx, motion.vy)
        if speed < REST_SPEED:
            motion = motion._replace(vx=0.0, vy=0.0)
            speed = 0.0
        self._motion = motion
        self._curve = curve_for(ice, curl, speed)
        self._tau = tau = self._curve.tau_at_speed(speed) if speed else 0.0
        self.change = self._curve.change if speed else 0.0
        self.start, self.stop = start, start + tau
        cell, s = self._curve.cell(tau)
        self.length = cubic(cell.straight, s)
        self._loss, self._unwound = cubic(cell.loss, s), cubic(cell.unwound, s)
        self._sense = sense = int(motion.omega > 0) - int(motion.omega < 0)
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
        self.end = Point(self._straight.x, self._straight.y, 0.0, self._straight.heading)
        # A law that takes no spin leaves it to the stone until it stops.
        self._pivot = self._curve.pivot
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
            theta = self._turned(self._tau_spin)
            theta += self._sense * (self._spin - self._pivot * since / 2) * since
            if self._tau == 0:
                x, y = self._motion.x, self._motion.y
            else:
                x, y = self._straight.x, self._straight.y
            return Motion(x, y, theta, 0.0, 0.0, self._sense * omega)
        cell, s = self._curve.cell(tau)
        spins = tau > self._tau_spin
        arc = self._arc if spins else self._straight
        x, y = arc.place(cell, s)
        heading, speed = arc.direction(cell, s), cubic(cell.speed, s)
        theta = self._turned(max(tau, self._tau_spin))
        omega = 0.0
        if spins and self._sense:
            omega = self._motion.omega + self._sense * (cubic(cell.loss, s) - self._loss)
        return Motion(x, y, theta, speed * math.cos(heading), speed * math.sin(heading), omega)

    def point(self, t: float) -> Point:
        """Place, speed and direction at the time `t` >= start; at rest the last direction."""
        tau = self.stop - t
        if tau <= 0:
            return self.end
        # The search for contacts asks for nothing else: what `_Arc` does, without its calls.
        (v0, v1, v2, v3), along, aside, turn, straight, _, _, node = self._curve.cell_at(tau)
        s = tau - node
        speed = v0 + s * (v1 + s * (v2 + s * v3))
        x, y, heading, cos, sin, sense = self._arc if tau > self._tau_spin else self._straight
        if not sense:
            c0, c1, c2, c3 = straight
            way = c0 + s * (c1 + s * (c2 + s * c3))
            return _new(Point, (x - cos * way, y - sin * way, speed, heading))
        c0, c1, c2, c3 = along
        d0, d1, d2, d3 = aside
        e0, e1, e2, e3 = turn
        way = c0 + s * (c1 + s * (c2 + s * c3))
        off = sense * (d0 + s * (d1 + s * (d2 + s * d3)))
        x, y = x - cos * way - sin * off, y - sin * way + cos * off
        return _new(Point, (x, y, speed, heading - sense * (e0 + s * (e1 + s * (e2 + s * e3)))))

    def places(self, t: Array) -> Array:
        """Places at times >= start, shape (n, 2), m: those of `point`."""
        tau = np.maximum(self.stop - t, 0.0)
        out = np.empty((len(t), 2))
        out[:] = self.end[:2]
        for arc, of in ((self._arc, tau > self._tau_spin), (self._straight, tau <= self._tau_spin)):
            rows = np.flatnonzero(of & (tau > 0))
            if not len(rows):
                continue
            along, aside = self._curve.ways(tau[rows], spins=arc.sense != 0)
            off = arc.sense * aside
            out[rows, 0] = arc.x - arc.cos * along - arc.sin * off
            out[rows, 1] = arc.y - arc.sin * along + arc.cos * off
        return out

    def _turned(self, tau: float) -> float:
        """Angle of the stone while it spins, `tau` before rest."""
        cell, s = self._curve.cell(tau)
        spin = self._motion.omega - self._sense * self._loss
        unwound = self._unwound - cubic(cell.unwound, s)
        return self._motion.theta + spin * (self._tau - tau) + self._sense * unwound
