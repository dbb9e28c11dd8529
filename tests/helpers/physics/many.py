"""What tests of many share."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from curlshot.physics.ice import IceLaw
from curlshot.physics.simulator.batch import FEW
from curlshot.physics.simulator.many import Outcomes
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, States, StoneStart

R = 0.145
COUNT = FEW + 12


def one_by_one(
    shot: Shot, states: States, ice: list[IceLaw] | None = None, restitution: Any = None
) -> list[Simulation]:
    """Simulate every variant by itself."""
    done = []
    columns: dict[str, Any] = vars(states)
    for s in range(len(states.x)):
        stones = tuple(
            replace(stone, **{key: float(value[s, k]) for key, value in columns.items()})
            for k, stone in enumerate(shot.stones)
        )
        own = replace(shot, stones=stones, ice=ice[s] if ice else shot.ice)
        if restitution is not None:
            own = replace(own, impact=replace(own.impact, restitution=restitution[s]))  # type: ignore[type-var]
        done.append(simulate(own))
    return done


def assert_same(out: Outcomes, alone: list[Simulation]) -> None:
    places = np.array([[(r.x, r.y) for r in done.rest.values()] for done in alone])
    np.testing.assert_allclose(np.stack([out.x, out.y], -1), places, atol=1e-6, rtol=0)
    hits = [[sum(n in hit.stones for hit in done.hits) for n in done.rest] for done in alone]
    assert out.hits.tolist() == hits


def thrown(shot: Shot, seed: int = 0) -> States:
    """Variants of a shot: the first stone thrown a little differently."""
    rng = np.random.default_rng(seed)
    states = States.of(shot, COUNT)
    states.x[:, 0] += rng.normal(0, 0.1, COUNT)
    states.vy[:, 0] *= rng.uniform(0.8, 1.2, COUNT)
    states.omega[:, 0] = rng.uniform(-2.5, 2.5, COUNT)
    return states


HOUSE = (
    StoneStart("A", 0.1, -3, 0.05, 2.0, 1.0),
    *(
        StoneStart(name, 0.45 * (k % 3 - 1), 0.4 * (k // 3) + 0.1 * (k % 2))
        for k, name in enumerate("BCDEFGH")
    ),
)
FROZEN = (
    StoneStart("A", 0.05, -2, 0, 1.8),
    StoneStart("B", 0, 0),
    StoneStart("C", 0, 2 * R),
    StoneStart("D", R * 3**0.5, R),
)
BOTH_MOVE = (
    StoneStart("A", 0, -2, 0.1, 1.8, 1.0),
    StoneStart("B", 1.2, -1, -0.6, 1.0, -2.0),
    StoneStart("C", 0.4, 0.5),
)
