"""From a clip to restitution and friction, in Python.

Run it as ``python examples/from_a_clip.py [CLIP]``. Without a clip the first two
seconds of the bundled sample are measured.
"""

from __future__ import annotations

import sys

from curlshot import pipeline
from curlshot.config import Config

clips = sys.argv[1:]
config = Config() if clips else Config().replace(frames=(0, 49))

done = pipeline.run(clips, config=config)  # with out="folder" it writes its files, too

results = done.results
print(f"e = {results.restitution.value} ± {results.restitution.stderr}")
print(f"μ = {results.friction.value} ± {results.friction.stderr}")
for hit in results.collisions:
    print(f"{hit.stones[0]} hit {hit.stones[1]} at {hit.t:.3f} s, n = {hit.normal}")
for warning in results.warnings:
    print("be careful:", warning)
print(done.tracks.groupby("stone")[["x", "y", "sd_x", "sd_y"]].last())
