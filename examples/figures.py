"""Figures and tables of a run, as in a notebook.

Run it as ``python examples/figures.py RUN [OUT]``. RUN is the folder that
`curlshot run` wrote. Each function gives a matplotlib Figure: after ``%matplotlib inline`` it shows
itself as the last line of a notebook's cell.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pandas as pd

from curlshot.data.results_file import read_results
from curlshot.data.sheet import HOUSE
from curlshot.data.tracks import read_tracks
from curlshot.report.figures import comparison_figure, hit_figure, motion_figure, plan_figure
from curlshot.report.tables import measured_table

if not sys.argv[1:]:
    print("usage: python examples/figures.py RUN [OUT]", file=sys.stderr)
    sys.exit(2)
run = Path(sys.argv[1])
out = Path(sys.argv[2]) if sys.argv[2:] else run

results = read_results(run / "results.json")
tracks = read_tracks(run / "tracks.csv")
simulations = dict(list(pd.read_csv(run / "simulation.csv").groupby("model")))
hits = results.collisions

plan_figure(tracks, simulations, hits, house=HOUSE).savefig(out / "my_plan.pdf")
motion_figure(tracks, "A", hits, results.glides).savefig(out / "my_motion.pdf")
comparison_figure(tracks, {"frictional": simulations["frictional"]}, "B", hits).savefig(
    out / "my_comparison.pdf"
)
hit_figure(hits[0]).savefig(out / "my_hit.png", dpi=300)

print(measured_table(hits).to_string(float_format=lambda value: f"{value:.4f}"))
