"""What tests of results file share."""

from __future__ import annotations

import json

from curlshot.data.results import (
    Estimate,
    Friction,
    Glide,
    Hit,
    Input,
    JointEstimate,
    Law,
    MeasuredState,
    Method,
    NotedEstimate,
    Posterior,
    Results,
    SimulationScore,
    StoneResult,
    TrackResidual,
)

RESULTS = Results(
    input=Input(("clip Ä.mp4",), 25.0, 150, 5.96),
    restitution=Estimate(0.83, 0.02),
    friction=Friction(0.0109, 3e-4, "constant"),
    collisions=(
        Hit(
            t=1.12,
            stderr_t=0.004,
            stones=("A", "B"),
            normal=(0.6, -0.8),
            restitution=0.81,
            stderr=0.03,
            before={"A": MeasuredState(0, 1, 0.05, -1.36, 0.66), "B": MeasuredState(0, 0, 0, 0)},
            after={
                "A": MeasuredState(0, 1, -0.4, -0.3, 2.0),
                "B": MeasuredState(0, 0, 0.4, -1.0, 1.5),
            },
            momentum_residual=0.05,
            energy_lost=0.2,
            note="seen for four frames only",
        ),
    ),
    glides=(Glide("A", 1.2, 5.5, 0.011, 4e-4), Glide("B", 1.2, 1.4, None, None)),
    simulations={
        "point-mass": SimulationScore(0.03, {"A": 0.05, "B": None}),
        "rigid-body": SimulationScore(None, note="no spins"),
    },
    warnings=("two frames are missing",),
    joint_estimate=JointEstimate(
        ("restitution", "friction"), (0.83, 0.0109), ((4e-4, 1e-7), (1e-7, 9e-8))
    ),
    methods={
        "local": Method(Estimate(0.82, 0.03), hits=(Estimate(0.81, 0.03),)),
        "shot_fit": Method(stone_friction=NotedEstimate(note="nothing slides"), note="not used"),
    },
    model_selection=(Law("ice constant", 0.0, 0.9, Estimate(0.0109, 3e-4)),),
    curl=NotedEstimate(0.008, 0.001),
    stones={
        "A": StoneResult(Estimate(0.01, 1e-3), Estimate(0.002, 0.001), 1.2, Estimate(0.6, 0.1))
    },
    residuals=(
        TrackResidual("A", 0.0, 1.2, 0.8, False, False),
        TrackResidual("A", 1.2, 5.5, 6.1, True, True),
    ),
    posterior=Posterior(100, {"restitution": {"0.5": 0.83}}, {"restitution": {"restitution": 1.0}}),
    teams={"A": "#d8c020"},
    origin_at_tee=False,
)


def strict(text: str) -> dict[str, object]:
    def refuse(word: str) -> float:
        raise AssertionError(f"{word} is no JSON")

    parsed = json.loads(text, parse_constant=refuse)
    assert isinstance(parsed, dict)
    return parsed
