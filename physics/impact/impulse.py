"""What all models of a hit share: axes, reduced mass, the impulse along the normal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


class After(NamedTuple):
    """Velocities (m/s, shape (..., 2)) and spins (rad/s, shape (...)) of both after a hit."""

    v1: Array
    v2: Array
    w1: Array
    w2: Array


_QUARTER_TURN = np.array([-1.0, 1.0])


def tangent(normal: ArrayLike) -> Array:
    """Return the unit tangents z × n of normals, shape (..., 2)."""
    n = np.asarray(normal, float)
    return np.asarray(n[..., ::-1] * _QUARTER_TURN)


def reduced_mass(mass1: ArrayLike, mass2: ArrayLike) -> Array:
    """Reduced mass m1 m2 / (m1 + m2)."""
    m1, m2 = np.asarray(mass1, float), np.asarray(mass2, float)
    return np.asarray(m1 * m2 / (m1 + m2))


def normal_impulse(
    restitution: ArrayLike,
    v1: ArrayLike,
    v2: ArrayLike,
    normal: ArrayLike,
    mass1: ArrayLike = 1.0,
    mass2: ArrayLike = 1.0,
) -> Array:
    """Impulse (1 + e) u_n m_r along the normal, positive for closing stones."""
    closing = dot(np.asarray(v1, float) - np.asarray(v2, float), np.asarray(normal, float))
    return np.asarray((1 + np.asarray(restitution)) * closing * reduced_mass(mass1, mass2))


def dot(a: Array, b: Array) -> Array:
    """Return the scalar products of vectors, shape (...)."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def kick(
    v1: ArrayLike,
    v2: ArrayLike,
    w1: ArrayLike,
    w2: ArrayLike,
    impulse: Array,
    mass1: ArrayLike,
    mass2: ArrayLike,
) -> After:
    """Take the impulse from stone 1 and give it to stone 2; spins stay."""
    return After(
        np.asarray(v1, float) - impulse / np.asarray(mass1, float)[..., None],
        np.asarray(v2, float) + impulse / np.asarray(mass2, float)[..., None],
        np.asarray(w1, float),
        np.asarray(w2, float),
    )
