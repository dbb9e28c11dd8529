"""What tests of bounds share."""

from __future__ import annotations

from curlshot.physics.curl import NoCurl
from curlshot.physics.ice import Constant
from curlshot.physics.impact import PointMass
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, StoneStart

R = 0.145
PLAY = Bounds()
SIDE, BACK, HOG = PLAY.half_width - R, PLAY.back_line + R, PLAY.hog_line - R


def straight(*stones: StoneStart, bounds: Bounds | None = PLAY) -> Simulation:
    """Constant friction, no curl."""
    return simulate(Shot(stones, PointMass(1.0), Constant(), NoCurl(), R, bounds))
