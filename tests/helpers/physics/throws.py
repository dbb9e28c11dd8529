"""What tests of throws share."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.watch import watch

MU = 0.05
"""Ice on which two throws take seconds."""
SECOND = 4.5
"""Time at which the second stone comes into view, s."""


def two_throws() -> pd.DataFrame:
    """A hits B; when both rest C comes in and hits A. In view is what is less than 2 m before."""
    slow = MU * 9.81

    def start(x: float, speed: float, when: float) -> Start:
        """State now of a stone that comes into view at a time."""
        return Start(x, -2.0 - speed * when - slow * when**2 / 2, 0.0, speed + slow * when, 0, 1)

    stones = [start(0.0, 2.0, 0.0), Start(0.05, 0.0), start(0.15, 2.2, SECOND)]
    ice, impact = Ice(b=MU), Impact(restitution=0.83, stone_friction=0.05)
    motion = simulate(stones, 8.0, ice=ice, impact=impact, step=5e-4, keep_every=4)
    seen = watch(motion, np.random.default_rng(3), sd=0.002)
    return seen[seen["y"] > -2.0].reset_index(drop=True)
