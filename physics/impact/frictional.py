"""Stones that rub on each other as they hit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from data.sheet import STONE
from physics.impact.impulse import After, dot, kick, normal_impulse, reduced_mass, tangent
from physics.registry import parameter


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

    restitution: float = parameter(1.0, 0.0, 1.0)
    stone_friction: float = parameter(0.2, 0.0, math.inf)
    inertia: float = parameter(STONE.inertia, 0.0, math.inf, above=True)
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
        slip = dot(np.asarray(v1, float) - np.asarray(v2, float), t) + radius * (w1 + w2)
        stick = -slip * reduced_mass(m1, m2) / (1 + 1 / self.inertia)
        limit = self.stone_friction * np.maximum(along, 0.0)
        aside = np.minimum(np.maximum(stick, -limit), limit)
        after = kick(v1, v2, w1, w2, along[..., None] * n - aside[..., None] * t, m1, m2)
        turn = aside / (self.inertia * radius)
        return after._replace(w1=w1 + turn / m1, w2=w2 + turn / m2)
