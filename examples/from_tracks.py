"""From a table of places to e and μ.

Run it as ``python examples/from_tracks.py [RUN]``. Any table will do that has the
columns stone, t, x and y in s and m: of another tracker, of a simulation, or as here of an earlier
run. Without one, a shot is made up.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from curlshot.data.sheet import STONE
from curlshot.data.tracks import check_detections
from curlshot.physics.estimate import estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart


def made_up() -> pd.DataFrame:
    """Give a hit as a camera sees it that is 3 mm off in every frame."""
    stones = (StoneStart("A", 0.05, 2.0, 0.0, -1.5), StoneStart("B", 0.0, 0.0))
    seen = simulate(Shot(stones)).sample(np.arange(0.0, 4.0, 1 / 30))
    seen[["x", "y"]] += np.random.default_rng(1).normal(0.0, 0.003, (len(seen), 2))
    return seen[["stone", "t", "x", "y"]]


RADIUS = STONE.radius  # of the discs, m

table = pd.read_csv(Path(sys.argv[1]) / "tracks.csv") if sys.argv[1:] else made_up()
detections = check_detections(table)
hits = detect_hits(detections, RADIUS)
found = estimate(detections, hits, radius=RADIUS)

print("hits:", [(f"{hit.t:.3f} s", hit.stones) for hit in hits])
print("e:", found.restitution)
print("μ:", found.friction)
for hit in found.collisions:
    name = hit.stones[1]
    state = hit.after[name]
    print(f"{name} leaves with ({state.vx:.3f} ± {state.sd_vx:.3f}, ", end="")
    print(f"{state.vy:.3f} ± {state.sd_vy:.3f}) m/s")
