"""What a hit does to two stones: one module per model, found by its name (`physics.registry`).

The normal n points from stone 1 to stone 2 and the tangent is t = z × n = (-n_y, n_x). The
contact lies at +R n of stone 1 and at -R n of stone 2, so its speed along t is v1·t + R ω1
on the one and v2·t - R ω2 on the other. All arrays, a model's parameters among them, may have
any leading shape.
"""

from __future__ import annotations

from typing import Protocol

from numpy.typing import ArrayLike

from data.sheet import STONE
from physics.impact.frictional import Frictional
from physics.impact.impulse import After, normal_impulse, reduced_mass, tangent
from physics.impact.point_mass import PointMass
from physics.impact.rigid_body import RigidBody

__all__ = [
    "After",
    "Frictional",
    "Impact",
    "PointMass",
    "RigidBody",
    "normal_impulse",
    "reduced_mass",
    "tangent",
]


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
