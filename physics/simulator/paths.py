"""Paths of many stones at once: what `physics.simulator.motion.Path` is for one, on arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.curl import Curl
from curlshot.physics.ice import IceLaw
from curlshot.physics.simulator.curve import (
    ALONG,
    ASIDE,
    LOSS,
    SPEED,
    STRAIGHT,
    TURN,
    cubics,
    curve_for,
)
from curlshot.physics.simulator.motion import REST_SPEED

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class CurveTable:
    """The curves of several laws, one below the other.

    Parameters
    ----------
    laws : sequence of (IceLaw, Curl)
        Ices and how stones curl on them; a pair is named by its place in this sequence.
    top : float
        Speed that no stone exceeds, m/s.

    Attributes
    ----------
    pivot : ndarray, shape (laws,)
        Loss of spin of a stone that turns on the spot, rad/s²; infinite where a law takes
        none, for a stone that stops then has lost all.
    """

    def __init__(self, laws: Sequence[tuple[IceLaw, Curl]], top: float) -> None:
        curves = [curve_for(*law, float(np.nextafter(top, np.inf))) for law in laws]
        pivot = np.array([curve.pivot for curve in curves])
        self.pivot = np.where(pivot > 0, pivot, np.inf)
        self._nodes = len(curves[0].tau)
        # Nodes lie evenly in a power of the speed, whatever the law.
        self._speed = curves[0].speed
        self._tau = np.concatenate([curve.tau for curve in curves])
        self._loss = np.concatenate([curve.loss for curve in curves])
        self._width = np.append(np.diff(self._tau), 0.0)
        # A constant added law by law makes one rising sequence of all.
        self._tau_span = self._tau.max() + 1.0
        self._loss_span = self._loss.max() + 1.0
        self._by_tau = self._rising(self._tau, self._tau_span)
        self._by_loss = self._rising(self._loss, self._loss_span)
        cells = np.concatenate(
            [np.pad(curve.coefficients, ((0, 1), (0, 0), (0, 0))) for curve in curves]
        )
        self._speeds, self._losses = cells[:, SPEED], cells[:, LOSS]
        spinning = cells[:, [SPEED, ALONG, ASIDE, TURN]]
        straight = cells[:, [SPEED, STRAIGHT, ASIDE, TURN]]
        straight[:, 2:] = 0.0
        # Straight pieces first; lowest power first in a row, four quantities each.
        self._glides = np.concatenate([straight, spinning]).transpose(0, 2, 1).copy()

    def _rising(self, values: Array, span: float) -> Array:
        return values + span * np.repeat(np.arange(len(values) // self._nodes), self._nodes)

    def glide(self, law: Index, tau: Array, spins: NDArray[np.bool_]) -> Array:
        """Speed, distance along and aside, turning to rest `tau` before rest, shape (n, 4)."""
        row = np.searchsorted(self._by_tau, law * self._tau_span + tau, side="right") - 1
        s = (tau - self._tau[row])[:, None]
        return cubics(self._glides[row + len(self._tau) * spins], s)

    def loss(self, law: Index, tau: Array) -> Array:
        """Spin lost from `tau` before rest on, rad/s, shape (n,)."""
        row = np.searchsorted(self._by_tau, law * self._tau_span + tau, side="right") - 1
        return cubics(self._losses[row], tau - self._tau[row])

    def tau_at_speed(self, law: Index, speed: Array) -> Array:
        """Time until rest at a speed, s, shape (n,)."""
        row = np.searchsorted(self._speed, speed, side="right") - 1 + law * self._nodes
        return np.asarray(self._tau[row] + _solve(self._speeds[row], speed, self._width[row]))

    def tau_at_loss(self, law: Index, loss: Array) -> Array:
        """Time until rest from which on that much spin is lost, s, shape (n,)."""
        row = np.searchsorted(self._by_loss, law * self._loss_span + loss, side="right") - 1
        return np.asarray(self._tau[row] + _solve(self._losses[row], loss, self._width[row]))


def _solve(c: Array, value: Array, width: Array) -> Array:
    """Where in 0..width the rising cubics have these values: Newton's method in a bracket."""
    low, high = np.zeros_like(width), width.copy()
    s = np.clip((value - c[:, 0]) / np.where(c[:, 1] > 0, c[:, 1], 1.0), low, high)
    for _ in range(60):
        f = cubics(c, s) - value
        high = np.where(f > 0, s, high)
        low = np.where(f > 0, low, s)
        slope = c[:, 1] + s * (2 * c[:, 2] + 3 * s * c[:, 3])
        new = s - f / np.where(slope > 0, slope, 1.0)
        new = np.where((slope > 0) & (low <= new) & (new <= high), new, (low + high) / 2)
        # A step of Newton's as short as this leaves no more than rounding.
        done = np.abs(new - s) <= 1e-10 * width
        s = new
        if done.all():
            break
    return s


class Paths:
    """The present path of each of `count` stones; see `curlshot.physics.simulator.motion.Path`.

    Attributes
    ----------
    stop : ndarray, shape (count,)
        Times at which the stones come to rest, s.
    """

    def __init__(self, table: CurveTable, law: Index) -> None:
        """Nothing is laid yet; `law` holds the place of each stone's laws in the table."""
        count = len(law)
        self._table, self._law = table, law
        self.stop = np.zeros(count)
        self._spin_ends = np.full(count, np.inf)
        # Straight piece and spinning one: x, y, heading, its cosine and sine, sense of spin.
        self._arcs = np.zeros((2, count, 6))
        self._omega, self._loss = np.zeros(count), np.zeros(count)

    def lay(self, which: Index, t: Array, place: Array, velocity: Array, omega: Array) -> None:
        """Give stones new paths from the times `t` on.

        Parameters
        ----------
        which : ndarray of int, shape (n,)
            The stones.
        t, omega : ndarray, shape (n,)
            Times (s) and spins (rad/s).
        place, velocity : ndarray, shape (n, 2)
            In m and m/s.
        """
        law, table = self._law[which], self._table
        speed = np.hypot(velocity[:, 0], velocity[:, 1])
        speed[speed < REST_SPEED] = 0.0
        tau = table.tau_at_speed(law, speed)
        sense = np.sign(omega)
        loss = table.loss(law, tau)
        heading = np.arctan2(velocity[:, 1], velocity[:, 0])
        spins = sense != 0
        glide = table.glide(law, tau, spins)
        arc = _arc(place, heading, sense, glide)
        straight = arc.copy()
        straight[:, 5] = 0.0
        spin_ends = np.where(spins, 0.0, np.inf)
        early = np.flatnonzero(spins & (np.abs(omega) < loss))
        if early.size:
            left = table.tau_at_loss(law[early], loss[early] - np.abs(omega[early]))
            spin_ends[early] = left
            yes = np.ones(early.size, bool)
            corner = _points(arc[early], table.glide(law[early], left, yes))
            onward = table.glide(law[early], left, ~yes)
            none = np.zeros(early.size)
            straight[early] = _arc(corner[:, :2], corner[:, 3], none, onward)
        self.stop[which] = t + tau
        self._spin_ends[which] = spin_ends
        self._arcs[0, which], self._arcs[1, which] = straight, arc
        self._omega[which], self._loss[which] = omega, loss

    def points(self, which: Index, t: Array) -> Array:
        """Place (m), speed (m/s) and direction (rad) of stones at the times t, shape (n, 4)."""
        tau = np.maximum(self.stop[which] - t, 0.0)
        spins = tau > self._spin_ends[which]
        arc = self._arcs[spins.astype(np.intp), which]
        return _points(arc, self._table.glide(self._law[which], tau, spins))

    def omega(self, which: Index, t: Array) -> Array:
        """Spins at the times t, rad/s, shape (n,)."""
        left = self.stop[which] - t
        omega = self._omega[which]
        law = self._law[which]
        lost = self._loss[which] - self._table.loss(law, np.maximum(left, 0.0))
        lost[left < 0] -= (self._table.pivot[law] * left)[left < 0]
        return np.asarray(np.sign(omega) * np.maximum(np.abs(omega) - lost, 0.0))


def _arc(place: Array, heading: Array, sense: Array, glide: Array) -> Array:
    """Lay the curve through places and directions where it has `glide` left to rest."""
    last = heading + sense * glide[:, 3]
    zero = np.zeros_like(last)
    arc = np.stack([zero, zero, last, np.cos(last), np.sin(last), sense], axis=1)
    arc[:, :2] = place - _points(arc, glide)[:, :2]
    return arc


def _points(arc: Array, glide: Array) -> Array:
    x, y, heading, cos, sin, sense = arc.T
    speed, along, aside, turn = glide.T
    aside = sense * aside
    return np.stack(
        [
            x - cos * along - sin * aside,
            y - sin * along + cos * aside,
            speed,
            heading - sense * turn,
        ],
        axis=1,
    )
