"""Figures and tables of a run, as in a notebook.

Run it as ``python examples/figures.py RUN [OUT]``. RUN is the folder that `curlshot run` wrote.
Each figure is drawn on new axes, which a notebook shows, or on those that are given.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

import curlshot

if not sys.argv[1:]:
    print("usage: python examples/figures.py RUN [OUT]", file=sys.stderr)
    sys.exit(2)
run = curlshot.load(sys.argv[1])
out = Path(sys.argv[2]) if sys.argv[2:] else Path(sys.argv[1])

run.plot().figure.savefig(out / "my_plan.pdf")
run.plot_motion("A")[0].figure.savefig(out / "my_motion.pdf")
run.plot_comparison("B", model="frictional")[0].figure.savefig(out / "my_comparison.pdf")
run.plot_hit(1)[0].figure.savefig(out / "my_hit.png", dpi=300)

figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
run.plot_speed(ax=left)
run.plot_friction(ax=right)
figure.savefig(out / "my_pair.pdf")

print(run.hits.T.to_string())
