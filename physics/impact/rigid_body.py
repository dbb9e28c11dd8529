"""Rigid stones whose spins after the hit are known."""

from __future__ import annotations

from dataclasses import dataclass

from curlshot.physics.impact.impulse import Before, Change, reduced_mass
from curlshot.physics.registry import parameter


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

    Examples
    --------
    >>> import curlshot
    >>> curlshot.RigidBody(restitution=0.83).needs_spin_after
    True
    """

    restitution: float = parameter(1.0, 0.0, 1.0)
    name = "rigid-body"
    needs_spin_after = True

    def change(self, before: Before) -> Change:
        """See `Impact.change`; ValueError without the spins after the hit."""
        if before.spin_after is None:
            raise ValueError("the rigid-body model needs the spins after the hit")
        w1, w2 = before.spin_after
        impulse = (1 + self.restitution) * before.closing * reduced_mass(before)
        return Change(
            -impulse / before.mass1,
            impulse / before.mass2,
            before.radius * (before.w1 - w1),
            -before.radius * (before.w2 - w2),
            w1,
            w2,
        )
