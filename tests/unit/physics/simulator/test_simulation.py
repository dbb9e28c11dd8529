from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import Constant, Fit
from curlshot.physics.impact import Frictional, PointMass
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import (
    SIMULATION_COLUMNS,
    Shot,
    States,
    StoneStart,
    check_shot,
)


def test_samples_form_a_table() -> None:
    stones = StoneStart("B", 0, 0, theta=0.7), StoneStart("A", 0.05, -1, 0, 1.5)
    sim = simulate(Shot(stones))
    times = np.array([0.0, 0.5, 1.0, 100.0])
    table = sim.sample(times)
    assert tuple(table.columns) == SIMULATION_COLUMNS
    assert table.stone.tolist() == ["A"] * 4 + ["B"] * 4
    assert table.frame.tolist() == [0, 1, 2, 3] * 2
    assert table.t.tolist() == times.tolist() * 2
    b = table[table.stone == "B"].iloc[0]
    assert (b.x, b.y, b.theta, b.vx, b.vy, b.omega) == (0, 0, 0.7, 0, 0, 0)
    last = table.groupby("stone").last()
    for name, rest in sim.rest.items():
        assert (last.x[name], last.y[name], last.theta[name]) == (rest.x, rest.y, rest.theta)
    assert sim.sample([]).empty
    for wrong in ([-0.1], [math.nan]):
        with pytest.raises(ValueError, match="finite times"):
            sim.sample(wrong)


def test_a_sample_at_a_hit_shows_the_state_after_it() -> None:
    sim = simulate(Shot((StoneStart("A", 0, -1, 0, 1.5), StoneStart("B", 0, 0))))
    hit = sim.hits[0]
    assert sim.sample([hit.t]).set_index("stone").vy["B"] == pytest.approx(
        hit.after["B"].vy, rel=1e-12
    )
    assert sim.state("A", hit.t).vy == pytest.approx(hit.after["A"].vy, rel=1e-12)
    assert sim.state("A", hit.t - 1e-9).vy == pytest.approx(hit.before["A"].vy, rel=1e-6)


def test_states_of_a_shot_repeat_its_stones() -> None:
    states = States.of(Shot((StoneStart("A", 0.1, -3, 0.2, 2.0, -1.5), StoneStart("B", 1, 2))), 3)
    assert {value.shape for value in vars(states).values()} == {(3, 2)}
    assert states.vy.tolist() == [[2.0, 0.0]] * 3
    assert states.omega.tolist() == [[-1.5, 0.0]] * 3


@pytest.mark.parametrize(
    ("stones", "message"),
    [
        ((), "no stone"),
        ((StoneStart("A", 0, 0), StoneStart("A", 1, 0)), "two stones named A"),
        ((StoneStart("A", 0, math.nan),), "stone A: y = nan is not finite"),
        ((StoneStart("A", 0, 0, mass=0),), "mass = 0 must be above 0"),
        ((StoneStart("A", 0, 0, 1e9),), "vx = 1e.09 is out of all bounds"),
        ((StoneStart("A", 0, 0), StoneStart("B", 0, 0)), "A and B overlap by 291 mm: move"),
        ((StoneStart("A", 0, 0, 0, 1), StoneStart("B", 0, 0.1)), "A and B overlap by 191 mm"),
        ((StoneStart("A", 0, 0, omega_after=(1.0, math.inf)),), "omega_after = inf"),
    ],
)
def test_mistakes_are_told(stones: tuple[StoneStart, ...], message: str) -> None:
    for refusing in (check_shot, simulate):
        with pytest.raises(InputError, match=message):
            refusing(Shot(stones))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ({"impact": PointMass(math.nan)}, "point-mass: restitution = nan is not finite"),
        ({"impact": PointMass(-0.1)}, "point-mass: restitution = -0.1 is too small"),
        ({"impact": Frictional(0.8, -0.1)}, "frictional: stone_friction = -0.1 is too small"),
        ({"impact": Frictional(0.8, 0.1, 0.0)}, "frictional: inertia = 0 is too small"),
        ({"ice": Constant(0.0)}, "constant: the ice must slow stones"),
        ({"ice": Fit(b=-1.0)}, "fit: the ice must slow stones"),
        ({"curl": FCV1Curl(turn=math.inf)}, "fcv1: turn = inf is not finite"),
        ({"curl": FCV1Curl(loss=-0.01)}, "fcv1: the ice must not speed up spins"),
    ],
)
def test_laws_that_make_no_sense_are_refused(law: dict[str, Any], message: str) -> None:
    stones = StoneStart("A", 0, 2, 0, -1.5), StoneStart("B", 0, 0)
    with pytest.raises(InputError, match=message):
        simulate(Shot(stones, **law), until=5.0)


def test_all_mistakes_are_told_at_once() -> None:
    with pytest.raises(InputError, match=r"radius = -1 .*; stone A: vy = inf"):
        check_shot(Shot((StoneStart("A", 0, 0, vy=math.inf),), radius=-1))
