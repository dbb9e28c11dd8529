"""A hit in its own axes: what models of it are given, what they give, and how vectors become it.

The models use plain arithmetic only, so that plain numbers stay such: for one hit alone they
are ten times as fast as arrays.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import STONE

Array = NDArray[np.float64]
Number = float | Array
"""One hit, or one of many in each element."""


class Before(NamedTuple):
    """Two stones as they hit each other.

    Attributes
    ----------
    closing, sliding : float or ndarray
        Components of v1 - v2 along the normal and the tangent, m/s; the first is positive.
    w1, w2 : float or ndarray
        Spins, rad/s.
    mass1, mass2 : float or ndarray
        Masses in any one unit.
    radius : float or ndarray
        Radius of both, m.
    spin_after : tuple of float or ndarray, optional
        Spins after the hit, rad/s, for the models that do not find them.
    """

    closing: Number
    sliding: Number
    w1: Number
    w2: Number
    mass1: Number = 1.0
    mass2: Number = 1.0
    radius: Number = STONE.radius
    spin_after: tuple[Number, Number] | None = None


class Change(NamedTuple):
    """What a hit does: changes of both velocities along normal and tangent; spins after it."""

    along1: Number
    along2: Number
    aside1: Number
    aside2: Number
    w1: Number
    w2: Number


class After(NamedTuple):
    """Velocities (m/s, shape (..., 2)) and spins (rad/s, shape (...)) of both after a hit."""

    v1: Array
    v2: Array
    w1: Array
    w2: Array


class Impact(Protocol):
    """What a hit does to two stones."""

    @property
    def name(self) -> str:
        """Name of the model, as in files and on the command line."""
        ...

    @property
    def needs_spin_after(self) -> bool:
        """Whether `change` must be told the spins after the hit."""
        ...

    def change(self, before: Before) -> Change:
        """Return what the hit changes."""
        ...


def resolve(
    impact: Impact,
    v1: ArrayLike,
    v2: ArrayLike,
    w1: ArrayLike,
    w2: ArrayLike,
    normal: ArrayLike,
    radius: Number = STONE.radius,
    *,
    mass1: ArrayLike = 1.0,
    mass2: ArrayLike = 1.0,
    spin_after: tuple[ArrayLike, ArrayLike] | None = None,
) -> After:
    """Return velocities and spins after hits.

    Parameters
    ----------
    impact : Impact
        The model.
    v1, v2 : array_like, shape (..., 2)
        Velocities before, m/s; the stones must be closing, (v1 - v2)·n > 0.
    w1, w2 : array_like, shape (...)
        Spins before, rad/s.
    normal : array_like, shape (..., 2)
        Unit vector from stone 1 to stone 2.
    radius, mass1, mass2, spin_after
        As of `Before`.

    Raises
    ------
    ValueError
        Where the model needs spins after the hit and has none.
    """
    n, one, two = (np.asarray(value, float) for value in (normal, v1, v2))
    t = tangent(n)
    a, b, m1, m2 = (np.asarray(value, float) for value in (w1, w2, mass1, mass2))
    spins = None
    if spin_after is not None:
        spins = np.asarray(spin_after[0], float), np.asarray(spin_after[1], float)
    apart = one - two
    change = impact.change(Before(_dot(apart, n), _dot(apart, t), a, b, m1, m2, radius, spins))
    along1, along2, aside1, aside2 = (np.asarray(part)[..., None] for part in change[:4])
    return After(
        one + along1 * n + aside1 * t,
        two + along2 * n + aside2 * t,
        np.asarray(change.w1),
        np.asarray(change.w2),
    )


def tangent(normal: ArrayLike) -> Array:
    """Return the unit tangents z × n of normals, shape (..., 2)."""
    n = np.asarray(normal, float)
    return np.stack([-n[..., 1], n[..., 0]], axis=-1)


def reduced_mass(before: Before) -> Number:
    """Reduced mass m1 m2 / (m1 + m2)."""
    return before.mass1 * before.mass2 / (before.mass1 + before.mass2)


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])
