"""From a table of places to e and μ.

Run it as ``python examples/from_tracks.py [RUN]``. Any table will do that has the columns stone, t,
x and y in s and m: of another tracker, of a simulation, or as here of an earlier run. Without one,
a shot is made up.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import curlshot


def made_up(folder: str) -> Path:
    """Write a hit as a camera measures it with errors of 3 mm."""
    stones = (curlshot.StoneStart("A", 0.05, 2.0, vy=-1.5), curlshot.StoneStart("B", 0.0, 0.0))
    seen = curlshot.simulate(curlshot.Shot(stones)).sample(np.arange(0.0, 4.0, 1 / 30))
    seen[["x", "y"]] += np.random.default_rng(1).normal(0.0, 0.003, (len(seen), 2))
    path = Path(folder) / "shot.csv"
    seen[["stone", "t", "x", "y"]].to_csv(path, index=False)
    return path


with tempfile.TemporaryDirectory() as folder:
    table = Path(sys.argv[1]) / "tracks.csv" if sys.argv[1:] else made_up(folder)
    run = curlshot.run(table)

print("e:", run.restitution)
print("μ:", run.friction)
for hit in run.results.collisions:
    name = hit.stones[1]
    state = hit.after[name]
    vx, vy = curlshot.Estimate(state.vx, state.sd_vx), curlshot.Estimate(state.vy, state.sd_vy)
    print(f"hit of {hit.stones} at {hit.t:.3f} s: {name} leaves with ({vx}, {vy}) m/s")
