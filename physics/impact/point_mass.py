"""Stones as point masses: the spins have no part in a hit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from data.sheet import STONE
from physics.impact.impulse import After, kick, normal_impulse
from physics.registry import parameter


@dataclass(frozen=True)
class PointMass:
    """Newton's law of restitution along the normal, nothing along the tangent, spins kept.

    J = (1 + e) u_n m_r with the reduced mass m_r = m1 m2 / (m1 + m2).

    Attributes
    ----------
    restitution : float
        Coefficient e, 0..1.
    """

    restitution: float = parameter(1.0, 0.0, 1.0)
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
        return kick(v1, v2, w1, w2, impulse[..., None] * n, mass1, mass2)
