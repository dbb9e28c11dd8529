"""What a hit does to two stones: one module per model, found by its name (`physics.registry`).

The normal n points from stone 1 to stone 2 and the tangent is t = z × n = (-n_y, n_x). The
contact lies at +R n of stone 1 and at -R n of stone 2, so its speed along t is v1·t + R ω1
on the one and v2·t - R ω2 on the other. All arrays, a model's parameters among them, may have
any leading shape.
"""

from __future__ import annotations

from curlshot.physics.impact.frictional import Frictional
from curlshot.physics.impact.impulse import (
    After,
    Before,
    Change,
    Impact,
    Number,
    reduced_mass,
    resolve,
    tangent,
)
from curlshot.physics.impact.point_mass import PointMass
from curlshot.physics.impact.rigid_body import RigidBody

__all__ = [
    "After",
    "Before",
    "Change",
    "Frictional",
    "Impact",
    "Number",
    "PointMass",
    "RigidBody",
    "reduced_mass",
    "resolve",
    "tangent",
]
