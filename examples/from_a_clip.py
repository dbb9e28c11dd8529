"""From a clip to restitution and friction, in Python.

Run it as ``python examples/from_a_clip.py [CLIP]``. Without a clip the first two
seconds of the bundled sample are measured.
"""

from __future__ import annotations

import sys

import curlshot

clips = sys.argv[1:]
config = curlshot.Config() if clips else curlshot.Config().replace(frames=(0, 49))

run = curlshot.run(clips, config=config)  # with out="folder" it writes its files, too

print("e =", run.restitution)
print("μ =", run.friction)
for hit in run.hits.to_dict("records"):
    print(f"{hit['first']} hit {hit['second']} at {hit['t']:.3f} s")
for warning in run.warnings:
    print("be careful:", warning)
print(run.stones[["stone", "x", "y", "sd_x", "sd_y", "top_speed"]])
