"""Rigid stones whose spins after the hit are known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from data.sheet import STONE
from physics.impact.impulse import After, kick, normal_impulse, tangent
from physics.registry import parameter


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

    restitution: float = parameter(1.0, 0.0, 1.0)
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
        after = kick(v1, v2, w1, w2, impulse[..., None] * n, mass1, mass2)
        a1, a2 = np.asarray(spin_after[0], float), np.asarray(spin_after[1], float)
        t = tangent(n)
        return After(
            after.v1 + (radius * (after.w1 - a1))[..., None] * t,
            after.v2 - (radius * (after.w2 - a2))[..., None] * t,
            a1,
            a2,
        )
