"""What a hit does to two stones: one frozen dataclass per model.

The normal n points from stone 1 to stone 2 and the tangent is t = z × n = (-n_y, n_x). The
contact lies at +R n of stone 1 and at -R n of stone 2, so its speed along t is v1·t + R ω1
on the one and v2·t - R ω2 on the other. All arrays may have any leading shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from data.sheet import STONE

Array = NDArray[np.float64]


IMPACT_MODELS: tuple[str, ...] = ("point-mass", "rigid-body", "frictional")


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
        """Whether `resolve` must be told the spins after the hit."""
        ...

    def resolve(
        self,
        v1: ArrayLike,
        v2: ArrayLike,
        w1: ArrayLike,
        w2: ArrayLike,
        normal: ArrayLike,
        radius: float = STONE.radius,
        *,
        mass1: ArrayLike = 1.0,
        mass2: ArrayLike = 1.0,
        spin_after: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> After:
        """Return velocities and spins after the hit.

        Parameters
        ----------
        v1, v2 : array_like, shape (..., 2)
            Velocities before, m/s; the stones must be closing, (v1 - v2)·n > 0.
        w1, w2 : array_like, shape (...)
            Spins before, rad/s.
        normal : array_like, shape (..., 2)
            Unit vector from stone 1 to stone 2.
        radius : float
            Radius of both, m.
        mass1, mass2 : array_like
            Masses in any one unit.
        spin_after : tuple of array_like, optional
            Spins after the hit, rad/s, for the models that do not find them.
        """
        ...


@dataclass(frozen=True)
class PointMass:
    """Newton's law of restitution along the normal, nothing along the tangent, spins kept.

    J = (1 + e) u_n m_r with the reduced mass m_r = m1 m2 / (m1 + m2).

    Attributes
    ----------
    restitution : float
        Coefficient e, 0..1.
    """

    restitution: float = 1.0
    name = "point-mass"
    needs_spin_after = False

    def resolve(
        self,
        v1: ArrayLike,
        v2: ArrayLike,
        w1: ArrayLike,
        w2: ArrayLike,
        normal: ArrayLike,
        radius: float = STONE.radius,
        *,
        mass1: ArrayLike = 1.0,
        mass2: ArrayLike = 1.0,
        spin_after: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> After:
        """See `Impact.resolve`; `radius` and `spin_after` are of no concern."""
        n = np.asarray(normal, float)
        impulse = normal_impulse(self.restitution, v1, v2, n, mass1, mass2)
        return _kick(v1, v2, w1, w2, impulse[..., None] * n, mass1, mass2)


@dataclass(frozen=True)
class RigidBody:
    """Rigid bodies with given spins after the hit; each contact point's tangential speed kept.

    Along the normal as `PointMass`. Along the tangent v1·t + R ω1 and v2·t - R ω2 stay what
    they were, so a change of spin shows as a change of velocity. This is the rigid-body
    analysis of the 2018 Olympic final's study, with the sign of stone 2's lever put right:
    its contact point lies at -R n. The tangential momentum is conserved only if both spins
    change by the same amount; the model itself does not see to that, nor to the energy.

    Attributes
    ----------
    restitution : float
        Coefficient e, 0..1.
    """

    restitution: float = 1.0
    name = "rigid-body"
    needs_spin_after = True

    def resolve(
        self,
        v1: ArrayLike,
        v2: ArrayLike,
        w1: ArrayLike,
        w2: ArrayLike,
        normal: ArrayLike,
        radius: float = STONE.radius,
        *,
        mass1: ArrayLike = 1.0,
        mass2: ArrayLike = 1.0,
        spin_after: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> After:
        """See `Impact.resolve`; ValueError without `spin_after`."""
        if spin_after is None:
            raise ValueError("the rigid-body model needs the spins after the hit")
        n = np.asarray(normal, float)
        impulse = normal_impulse(self.restitution, v1, v2, n, mass1, mass2)
        after = _kick(v1, v2, w1, w2, impulse[..., None] * n, mass1, mass2)
        a1, a2 = np.asarray(spin_after[0], float), np.asarray(spin_after[1], float)
        t = tangent(n)
        return After(
            after.v1 + (radius * (after.w1 - a1))[..., None] * t,
            after.v2 - (radius * (after.w2 - a2))[..., None] * t,
            a1,
            a2,
        )


@dataclass(frozen=True)
class Frictional:
    """Restitution along the normal, Coulomb's friction along the tangent, stick or slip.

    J_n = (1 + e) u_n m_r; J_t = clip(-u_t m_r / (1 + 1/k), ±μ_s J_n) with the slip
    u_t = (v1 - v2)·t + R (ω1 + ω2). Both spins change by J_t / (k m R). Spin and orbital
    angular momentum are conserved together.

    Attributes
    ----------
    restitution : float
        Coefficient e, 0..1.
    stone_friction : float
        Coefficient of friction between the stones, μ_s >= 0.
    inertia : float
        k in the moment of inertia k m R².
    """

    restitution: float = 1.0
    stone_friction: float = 0.2
    inertia: float = STONE.inertia
    name = "frictional"
    needs_spin_after = False

    def resolve(
        self,
        v1: ArrayLike,
        v2: ArrayLike,
        w1: ArrayLike,
        w2: ArrayLike,
        normal: ArrayLike,
        radius: float = STONE.radius,
        *,
        mass1: ArrayLike = 1.0,
        mass2: ArrayLike = 1.0,
        spin_after: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> After:
        """See `Impact.resolve`; `spin_after` is of no concern."""
        n = np.asarray(normal, float)
        t = tangent(n)
        m1, m2 = np.asarray(mass1, float), np.asarray(mass2, float)
        w1, w2 = np.asarray(w1, float), np.asarray(w2, float)
        along = normal_impulse(self.restitution, v1, v2, n, m1, m2)
        slip = _dot(np.asarray(v1, float) - np.asarray(v2, float), t) + radius * (w1 + w2)
        stick = -slip * reduced_mass(m1, m2) / (1 + 1 / self.inertia)
        limit = self.stone_friction * np.maximum(along, 0.0)
        aside = np.clip(stick, -limit, limit)
        after = _kick(v1, v2, w1, w2, along[..., None] * n - aside[..., None] * t, m1, m2)
        turn = aside / (self.inertia * radius)
        return after._replace(w1=w1 + turn / m1, w2=w2 + turn / m2)


def tangent(normal: ArrayLike) -> Array:
    """Return the unit tangents z × n of normals, shape (..., 2)."""
    n = np.asarray(normal, float)
    return np.stack([-n[..., 1], n[..., 0]], axis=-1)


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
    closing = _dot(np.asarray(v1, float) - np.asarray(v2, float), np.asarray(normal, float))
    return np.asarray((1 + np.asarray(restitution)) * closing * reduced_mass(mass1, mass2))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def _kick(
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
