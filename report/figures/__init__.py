"""The figures of a shot: each one function on the tables, returning a matplotlib `Figure`.

All lengths in m, times in s, angles in rad. The tables are `curlshot.data.tracks.TRACK_COLUMNS` for
what was measured and ``stone, frame, t, x, y, theta, vx, vy, omega`` for what was simulated.
A figure belongs to no window: save it with ``savefig``, or after ``%matplotlib inline`` show it as
the last line of a notebook's cell.
"""

from curlshot.report.figures.comparison import comparison_figure
from curlshot.report.figures.friction import friction_figure
from curlshot.report.figures.hit import hit_figure
from curlshot.report.figures.labels import name_stones
from curlshot.report.figures.motion import motion_figure, speed_figure, spin_figure
from curlshot.report.figures.plan import draw_house, plan_figure
from curlshot.report.figures.posterior import posterior_figure
from curlshot.report.figures.residuals import residuals_figure
from curlshot.report.figures.simulated import simulated_figure

__all__ = [
    "comparison_figure",
    "draw_house",
    "friction_figure",
    "hit_figure",
    "motion_figure",
    "name_stones",
    "plan_figure",
    "posterior_figure",
    "residuals_figure",
    "simulated_figure",
    "speed_figure",
    "spin_figure",
]
