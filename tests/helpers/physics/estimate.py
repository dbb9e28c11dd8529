"""What tests of estimate share."""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd

from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.physics import Motion
from curlshot.tests.helpers.physics.watch import (
    RADIUS,
    hit_motion,
    watch,
)


def measure(seen: pd.DataFrame, radius: float = RADIUS) -> Estimates:
    return estimate(seen, detect_hits(seen, radius), radius=radius)


@cache
def repeated(sd: float, fps: float, speed: float, given: bool) -> tuple[Motion, list[Estimates]]:
    """A hit, and what is measured of it with other noise each time."""
    motion = hit_motion(speed, 0.06, before=1.0, after=2.0, restitution=0.8, stone_friction=0.1)
    rng = np.random.default_rng(11)
    return motion, [measure(watch(motion, rng, fps=fps, sd=sd, given=given)) for _ in range(14)]


CASES = [(0.01, 30, 2.0, True), (0.003, 25, 1.0, False)]
