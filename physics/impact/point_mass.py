"""Stones as point masses: the spins have no part in a hit."""

from __future__ import annotations

from dataclasses import dataclass

from curlshot.physics.impact.impulse import Before, Change, reduced_mass
from curlshot.physics.registry import parameter


@dataclass(frozen=True)
class PointMass:
    """Newton's law of restitution along the normal, nothing along the tangent, spins kept.

    J = (1 + e) u_n m_r with the reduced mass m_r = m1 m2 / (m1 + m2).

    Attributes
    ----------
    restitution : float
        Coefficient e, 0..1.

    Examples
    --------
    >>> import curlshot
    >>> curlshot.PointMass(restitution=0.83).name
    'point-mass'
    """

    restitution: float = parameter(1.0, 0.0, 1.0)
    name = "point-mass"
    needs_spin_after = False

    def change(self, before: Before) -> Change:
        """See `Impact.change`; radius and spins after the hit are of no concern."""
        impulse = (1 + self.restitution) * before.closing * reduced_mass(before)
        return Change(
            -impulse / before.mass1, impulse / before.mass2, 0.0, 0.0, before.w1, before.w2
        )
