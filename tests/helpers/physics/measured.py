"""Tracks and results of a shot that the simulator moved, as a run writes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from curlshot.data.results import Estimate, Friction, Hit, Input, MeasuredState, Results
from curlshot.physics.curl import NoCurl
from curlshot.physics.ice import Constant
from curlshot.physics.impact import Frictional
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart

R = 0.1455
MU = 0.0105
HIT = Shot(
    (StoneStart("A", 0.2, 3.0, 0.0, -1.6, 0.5), StoneStart("B", 0.1, 0.5), StoneStart("C", -1, -1)),
    Frictional(0.8, 0.05),
    Constant(MU),
    NoCurl(),
    R,
    Bounds(-1),
)


def measured(shot: Shot = HIT) -> tuple[pd.DataFrame, Results, Ensemble]:
    """Tracks, results and ensemble of a shot with one hit, as a run would write them.

    Nothing is open but the speed of the first stone, to 1 and 2 mm/s, e, to .01 and .02.
    """
    done = simulate(shot)
    (hit,) = done.hits
    tracks = done.sample(np.arange(0, 6, 0.04))
    for key in ("x", "y", "theta", "vx", "vy", "omega"):
        tracks[f"sd_{key}"] = 0.004
    tracks["seen"] = 1
    before, after = (
        {name: MeasuredState(s.x, s.y, s.vx, s.vy, s.omega) for name, s in side.items()}
        for side in (hit.before, hit.after)
    )
    collision = Hit(
        hit.t, 0.001, hit.stones, hit.normal, 0.8, 0.02, before, after,
        stone_friction=0.05, stderr_stone_friction=0.01,
    )  # fmt: skip
    results = Results(
        Input(("clip.mp4",), 25.0, 150, 6.0),
        Estimate(0.8, 0.02),
        Friction(MU, 0.0002),
        (collision,),
        radius=R,
    )
    boundless = replace(shot, bounds=None)
    others = [
        replace(
            boundless,
            stones=(replace(shot.stones[0], vy=shot.stones[0].vy + 0.001 * k), *shot.stones[1:]),
            impact=Frictional(0.8 + 0.01 * k, 0.05),
        )
        for k in (-2, -1, 1, 2)
    ]
    return tracks, results, Ensemble(0.0, boundless, others)
