"""What if the stone had been thrown 5 cm to the left.

Run it as ``python examples/what_if.py RUN``. RUN is the folder that `curlshot run` wrote.
"""

from __future__ import annotations

import sys
from pathlib import Path

from curlshot.data.results_file import read_results
from curlshot.data.tracks import read_tracks
from curlshot.physics.prediction.ensemble import read_ensemble
from curlshot.physics.prediction.start import measured_start
from curlshot.physics.prediction.what_if import Amount, Changes, changed, odds, sample

if not sys.argv[1:]:
    print("usage: python examples/what_if.py RUN", file=sys.stderr)
    sys.exit(2)
run = Path(sys.argv[1])
start = measured_start(
    read_tracks(run / "tracks.csv"),
    read_results(run / "results.json"),
    read_ensemble(run / "ensemble.json"),
)

for words, changes in (
    ("as thrown", Changes()),
    ("5 cm to the left", Changes(aim_offset=0.05)),
    ("a tenth faster", Changes(speed=Amount(1.1, relative=True))),
):
    start_now = changed(start, changes)
    outcomes = sample(start_now, 200)  # each a little off, as players throw and stones are known
    print(words)
    for name, stone in odds(outcomes, start_now).items():
        if stone.moved > 0.5:
            print(f"  {name}: in the house {stone.in_house:.0%}, shot stone {stone.shot_stone:.0%}")
