"""What a coach asks of a shot, in feet.

Run it as ``python examples/coach.py RUN``. RUN is the folder that `curlshot run` wrote.
"""

from __future__ import annotations

import sys

import curlshot
from curlshot.data.coach_units import FEET
from curlshot.report.tables import shot_stone, speed_table, takeout_table

if not sys.argv[1:]:
    print("usage: python examples/coach.py RUN", file=sys.stderr)
    sys.exit(2)
run = curlshot.load(sys.argv[1])
hits = run.results.collisions

stones = run.stones
name, why = shot_stone(stones)
print(f"shot stone: {name or 'not known'} ({why})")
for stone in stones.to_dict("records"):
    known = stone["to_tee"] >= 0  # NaN where the clip cannot tell; the note says why
    place = (
        f"{FEET.length(stone['to_tee'])} from the tee" if known else FEET.converted(stone["note"])
    )
    print(f"  {stone['stone']}: {place}")

for row in speed_table(run.tracks, hits).to_dict("records"):
    speed = curlshot.Estimate(row["speed"] * FEET.per_metre, row["sd"] * FEET.per_metre)
    said = f"{speed:.3f} ft/s" if row["speed"] >= 0 else FEET.converted(row["note"])
    print(f"  {row['stone']}, {row['at']}: {said}")

for row in takeout_table(hits).to_dict("records"):
    print(f"  {row['stones']}: {row['share']:.0%} of its speed lost")
