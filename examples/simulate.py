"""A shot of one's own, simulated with three kinds of hit.

Run it as ``python examples/simulate.py``.
"""

from __future__ import annotations

from curlshot.physics.impact import Frictional, PointMass
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart

stones = (
    StoneStart("A", x=0.3, y=6.0, vx=0.0, vy=-2.2, omega=1.5),
    StoneStart("B", x=0.2, y=0.5),
    StoneStart("C", x=-0.3, y=-0.6),
)

for words, impact in (
    ("smooth stones", PointMass(restitution=0.83)),
    ("stones that rub", Frictional(restitution=0.83, stone_friction=0.05)),
    ("dead stones", PointMass(restitution=0.3)),
):
    run = simulate(Shot(stones, impact))
    print(words)
    for hit in run.hits:
        print(f"  {hit.t:.2f} s: {hit.stones[0]} on {hit.stones[1]}")
    for name, rest in run.rest.items():
        print(f"  {name} stops at ({rest.x:+.2f}, {rest.y:+.2f}) m after {rest.t:.1f} s")
