"""What tests of motion share."""

from __future__ import annotations

from curlshot.physics.ice import FCV1, Constant, Fit, Penner
from curlshot.physics.simulator.motion import Motion

LAWS = [Constant(), FCV1(), Penner(), Fit()]


def along_y(speed: float, omega: float = 0.0) -> Motion:
    return Motion(0.0, 0.0, 0.0, 0.0, speed, omega)
