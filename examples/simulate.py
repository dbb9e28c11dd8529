"""A shot of one's own, simulated with three kinds of hit.

Run it as ``python examples/simulate.py``.
"""

from __future__ import annotations

import curlshot

stones = (
    curlshot.StoneStart("A", x=0.3, y=6.0, vy=-2.2, omega=1.5),
    curlshot.StoneStart("B", x=0.2, y=0.5),
    curlshot.StoneStart("C", x=-0.3, y=-0.6),
)

for words, impact in (
    ("smooth stones", curlshot.PointMass(restitution=0.83)),
    ("stones that rub", curlshot.Frictional(restitution=0.83, stone_friction=0.05)),
    ("dead stones", curlshot.PointMass(restitution=0.3)),
):
    print(words)
    print(curlshot.simulate(curlshot.Shot(stones, impact)))
