"""One e, and one friction between stones, for several shots of the same stones.

Run it as ``python examples/shared.py [RUN ...]``, with the folders of runs. Without any, two shots
are made up. All detections of all shots are fitted at once through the simulator, where e and the
friction between stones are the same in all of them and what is left is each shot's own.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd

import curlshot
from curlshot.data.sheet import STONE
from curlshot.data.tracks import check_detections
from curlshot.physics.estimate import estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.shot_fit.global_fit import fit_shots
from curlshot.pipeline import measure

RADIUS = STONE.radius  # of the discs, m


def made_up(speed: float, offset: float) -> pd.DataFrame:
    """Return a hit as a camera measures it with errors of 3 mm."""
    stones = curlshot.StoneStart("A", 0.0, 2.0, vy=-speed), curlshot.StoneStart("B", offset, 0.0)
    shot = curlshot.Shot(stones, curlshot.Frictional(0.83))
    seen = curlshot.simulate(shot).sample(np.arange(0.0, 3.0, 1 / 30))
    seen[["x", "y"]] += np.random.default_rng(1).normal(0.0, 0.003, (len(seen), 2))
    return check_detections(seen[["stone", "t", "x", "y"]])


runs = [measure(Path(run) / "tracks.csv").detections for run in sys.argv[1:]]
fits = []
for detections in runs or [made_up(1.5, 0.05), made_up(2.0, -0.08)]:
    found = estimate(detections, detect_hits(detections, RADIUS), radius=RADIUS)
    if found.shot_fit is None:
        sys.exit(f"no shot fit: {found.by_shot_fit.note}")
    fits.append(found.shot_fit)
    print("by itself: e =", found.shot_fit["restitution"], " μ =", found.shot_fit["friction"])

held = {name: value for fit in fits for name, value in fit.fixed.items()}
shots = [shot for fit in fits for shot in fit.shots]
together = fit_shots(shots, fixed=held, shared=["restitution", "stone_friction"])
print("together:  e =", together["restitution"])
for rank in range(len(shots)):
    name = f"{rank}:friction" if len(shots) > 1 else "friction"
    print(f"shot {rank}:    μ =", together[name])
