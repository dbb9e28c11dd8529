"""Stones that rub on each other as they hit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from curlshot.data.sheet import STONE
from curlshot.physics.impact.impulse import Before, Change, Number, reduced_mass
from curlshot.physics.registry import parameter


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

    Examples
    --------
    >>> import curlshot
    >>> curlshot.Frictional(restitution=0.83).inertia
    0.5
    """

    restitution: float = parameter(1.0, 0.0, 1.0)
    stone_friction: float = parameter(0.2, 0.0, math.inf)
    inertia: float = parameter(STONE.inertia, 0.0, math.inf, above=True)
    name = "frictional"
    needs_spin_after = False

    def change(self, before: Before) -> Change:
        """See `Impact.change`; spins after the hit are found, not asked for."""
        _, _, w1, w2, m1, m2, radius, _ = before
        mass = reduced_mass(before)
        along = (1 + self.restitution) * before.closing * mass
        slip = before.sliding + radius * (w1 + w2)
        aside = _clipped(-slip * mass / (1 + 1 / self.inertia), self.stone_friction * along)
        turn = aside / (self.inertia * radius)
        return Change(
            -along / m1, along / m2, aside / m1, -aside / m2, w1 + turn / m1, w2 + turn / m2
        )


def _clipped(value: Number, limit: Number) -> Number:
    """Value within ± a limit."""
    if isinstance(value, float) and isinstance(limit, float):
        return min(max(value, -limit), limit)
    return np.asarray(np.clip(value, -limit, limit))
