"""The one curve of all glides on one ice, tabulated once and laid through any stone's state.

Between two hits a stone's speed falls by the ice law alone, and the direction of its path
turns at a rate that depends on the speed and on the sense of the spin alone. So every glide
on one ice is a piece of one and the same curve, shifted, rotated and mirrored. `Curve` holds
that curve by the time that is left until rest. (A law of curl that asks for the amount of the
spin too would need a curve for every path.)
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.curl import Curl
from curlshot.physics.ice import IceLaw

Array = NDArray[np.float64]
Cubic = tuple[float, float, float, float]

CELLS = 1024
"""Cells of a curve: places are then good to 1e-8 m after 100 m on any ice known."""
LOWEST_TOP = 4.0
"""A curve reaches this speed at least, m/s, so that most shots share one."""


class Cell(NamedTuple):
    """Cubics over one cell of a curve, in s = τ - τ_k, lowest power first; τ_k is its node."""

    speed: Cubic
    along: Cubic
    aside: Cubic
    turn: Cubic
    straight: Cubic
    loss: Cubic
    unwound: Cubic
    node: float


GAUSS = (np.polynomial.legendre.leggauss(5)[0] + 1) / 2
"""Where in a cell, as shares of it, Gauss and Legendre's rule takes what it integrates."""
_POWERS = np.arange(1, len(GAUSS) + 1)
_BASIS = np.linalg.inv(np.vander(GAUSS, increasing=True))
TO_INNER = (GAUSS[:, None] ** _POWERS / _POWERS) @ _BASIS
TO_END = (1 / _POWERS) @ _BASIS
"""From the values there to integrals up to each of them, and over the cell, in its widths."""

SPEED, ALONG, ASIDE, TURN, STRAIGHT, LOSS = range(6)
"""Columns of `Curve.coefficients`, in the order of `Cell`."""


def cubic(c: Cubic, s: float) -> float:
    """Value of a cubic."""
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]))


def cubics(c: Array, s: Array) -> Array:
    """Values of cubics, whose coefficients are the second axis, lowest power first."""
    return np.asarray(c[:, 0] + s * (c[:, 1] + s * (c[:, 2] + s * c[:, 3])))


@dataclass(frozen=True, repr=False, eq=False)
class Curve:
    """The one curve of all glides, by the time τ that is left until rest.

    Attributes
    ----------
    tau, speed, loss : ndarray, shape (cells + 1,)
        Times of the nodes, s, from 0 upwards; speed (m/s) and spin lost from there to rest
        (rad/s) at the nodes.
    coefficients : ndarray, shape (cells, 7, 4)
        Cubics of each cell in the order of `Cell`: speed; distance to rest along the last
        direction and aside of it; turning to rest; distance to rest along a straight path;
        spin lost; its integral over τ.
    pivot : float
        Loss of spin of a stone that turns on the spot, rad/s².
    change : float
        Greatest change of the velocity in a time, m/s².
    """

    tau: Array
    speed: Array
    loss: Array
    coefficients: Array
    pivot: float
    change: float

    @cached_property
    def _nodes(self) -> tuple[list[float], list[float], list[float]]:
        return self.tau.tolist(), self.speed.tolist(), self.loss.tolist()

    @cached_property
    def _cells(self) -> list[Cell | None]:
        """Cells as plain numbers, made when first asked for: a shot visits but a few."""
        return [None] * len(self.coefficients)

    @cached_property
    def _inner(self) -> list[float]:
        """Nodes between two cells."""
        return self._nodes[0][1:-1]

    def _cell(self, k: int) -> Cell:
        cell = self._cells[k]
        if cell is None:
            cubics = map(tuple, self.coefficients[k].tolist())
            cell = self._cells[k] = Cell._make([*cubics, self._nodes[0][k]])
        return cell

    def cell_at(self, tau: float) -> Cell:
        """Return the cell that holds `tau` >= 0."""
        k = bisect_right(self._inner, tau)
        return self._cells[k] or self._cell(k)

    def cell(self, tau: float) -> tuple[Cell, float]:
        """Return the cell that holds `tau` and the time since its first node."""
        cell = self.cell_at(tau)
        return cell, tau - cell.node

    def ways(self, tau: Array, *, spins: bool) -> tuple[Array, Array]:
        """Distances to rest along the last direction and aside of it, m, at times >= 0 before."""
        k = np.searchsorted(self.tau[1:-1], tau, side="right")
        s = tau - self.tau[k]
        if not spins:
            return cubics(self.coefficients[k, STRAIGHT], s), np.zeros(len(tau))
        return cubics(self.coefficients[k, ALONG], s), cubics(self.coefficients[k, ASIDE], s)

    def tau_at_speed(self, speed: float) -> float:
        """Time until rest of a stone with that speed, s."""
        tau, speeds, _ = self._nodes
        k = min(bisect_right(speeds, speed), len(tau) - 1) - 1
        return tau[k] + _solve(self._cell(k).speed, speed, tau[k + 1] - tau[k])

    def tau_at_loss(self, loss: float) -> float:
        """Time until rest from which on a stone loses that much spin, s."""
        tau, _, losses = self._nodes
        k = min(bisect_right(losses, loss), len(tau) - 1) - 1
        return tau[k] + _solve(self._cell(k).loss, loss, tau[k + 1] - tau[k])


def _solve(c: Cubic, value: float, width: float) -> float:
    """Where in 0..width the rising cubic has that value: Newton's method in a bracket."""
    low, high = 0.0, width
    s = min(max((value - c[0]) / c[1], low), high) if c[1] > 0 else width / 2
    for _ in range(60):
        f = cubic(c, s) - value
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
def _grid(top: float, cells: int) -> tuple[float, Array, Array, Array]:
    """Width of a cell in v^(1/5), speeds of nodes and within cells, and dv / d(v^(1/5)) there."""
    u = np.linspace(0.0, top**0.2, cells + 1)
    inner_u = u[:-1, None] + u[1] * GAUSS
    return float(u[1]), u**5, inner_u**5, 5 * inner_u**4


@lru_cache(maxsize=256)
def curve(ice: IceLaw, curl: Curl, top: float = LOWEST_TOP, cells: int = CELLS) -> Curve:
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
    width, v, inner_v, per_speed = _grid(top, cells)

    def integral(rate: Array) -> tuple[Array, Array]:
        inner = width * rate @ TO_INNER.T
        nodes = np.zeros(cells + 1)
        np.cumsum(width * rate @ TO_END, out=nodes[1:])
        return nodes[:-1, None] + inner, nodes

    dtau = per_speed / ice.deceleration(inner_v)
    _, tau = integral(dtau)
    _, straight = integral(inner_v * dtau)
    inner_turn, turn = integral(curl.turn_rate(inner_v) * dtau)
    _, along = integral(inner_v * np.cos(inner_turn) * dtau)
    _, aside = integral(inner_v * np.sin(inner_turn) * dtau)
    inner_loss, loss = integral(curl.spin_loss(inner_v) * dtau)
    _, unwound = integral(inner_loss * dtau)

    moving = v[1:]
    slowing, turning = ice.deceleration(moving), curl.turn_rate(moving)
    values = (v, along, aside, turn, straight, loss, unwound)
    slopes = (
        slowing,
        moving * np.cos(turn[1:]),
        moving * np.sin(turn[1:]),
        turning,
        moving,
        curl.spin_loss(moving),
        loss[1:],
    )
    cubics = _hermite(tau, np.stack(values), np.stack(slopes))
    change = np.hypot(slowing, moving * turning)
    return Curve(tau, v, loss, cubics, float(curl.spin_loss(0.0)), float(change.max()))


def _hermite(tau: Array, value: Array, slope: Array) -> Array:
    """Coefficients of the cubics with those values and slopes, shape (cells, quantities, 4).

    The slope at rest, where laws may have a pole, is taken as that of the chord.
    """
    h = np.diff(tau)
    chord = np.diff(value) / h
    left = np.concatenate([chord[:, :1], slope[:, :-1]], axis=1)
    out = np.empty((len(h), len(value), 4))
    out[..., 0] = value[:, :-1].T
    out[..., 1] = left.T
    out[..., 2] = ((3 * chord - 2 * left - slope) / h).T
    out[..., 3] = ((left + slope - 2 * chord) / h**2).T
    return out


def curve_for(ice: IceLaw, curl: Curl, speed: float) -> Curve:
    """Return a curve that reaches `speed`: one for all up to 4 m/s, others by doubling."""
    top = LOWEST_TOP
    while top < speed:
        top *= 2
    return curve(ice, curl, top)
