"""Results of one shot with a hit, and of one without."""

from __future__ import annotations

from dataclasses import replace

from curlshot.data.results import Estimate, Friction, Hit, Input, MeasuredState, Results

HIT = Hit(
    1.0, 0.01, ("A", "B"), (0.6, 0.8), 0.82, 0.01,
    {"A": MeasuredState(0, 0, 1.2, 1.6), "B": MeasuredState(0.1, 0.2, 0.3, 0.4)},
    {"A": MeasuredState(0, 0, 0.2, 0.3), "B": MeasuredState(0.1, 0.2, 1.0, 1.1)},
)  # fmt: skip
SHOT = Results(
    Input(("a.mp4",), 25.0, 100, 4.0),
    Estimate(0.82, 0.01),
    Friction(0.011, 0.0002),
    (HIT,),
)
BARE = replace(SHOT, restitution=Estimate(), friction=Friction(), collisions=())
