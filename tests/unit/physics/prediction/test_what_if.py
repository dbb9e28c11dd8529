from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.sheet import GRAVITY
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Fit, Penner
from curlshot.physics.impact import Frictional, PointMass
from curlshot.physics.prediction.start import Start, measured_start, written_start
from curlshot.physics.prediction.what_if import Amount, Changes, changed, odds, sample
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.tests.helpers.physics.measured import HIT, MU, R, measured


def test_changes_are_made_to_the_thrown_stone_and_the_laws() -> None:
    start = written_start(HIT)
    after = changed(start, Changes(0.9, 0.012, Amount(1.1, True), Amount(-1.0), 0.05)).shot
    a = after.stones[0]
    # It moves towards -y: its left is +x.
    assert (a.x, a.y) == pytest.approx((0.25, 3.0))
    assert (a.vx, a.vy, a.omega) == pytest.approx((0, -1.76, -1.0))
    assert after.stones[1:] == HIT.stones[1:]
    assert after.impact == Frictional(0.9, 0.05)
    assert float(after.ice.deceleration(1.0)) == pytest.approx(0.012 * GRAVITY)
    law = replace(start, shot=replace(HIT, ice=FCV1()))
    ratio = changed(law, Changes(friction=0.01)).shot.ice.deceleration([0.2, 1, 3.0])
    ratio /= FCV1().deceleration([0.2, 1, 3.0])
    assert ratio == pytest.approx(ratio[0])
    with pytest.raises(InputError, match="on top of B"):
        changed(
            written_start(replace(HIT, stones=(HIT.stones[0], StoneStart("B", 0.6, 3.0)))),
            Changes(aim_offset=0.3),
        )
    with pytest.raises(InputError, match="A would start outside the sheet"):
        changed(written_start(replace(HIT, bounds=Bounds(-1))), Changes(aim_offset=2.1))


def test_the_spread_of_a_lone_stone_is_that_of_its_throw() -> None:
    """Thrown from the hog line: d(way) = v dv / (μ g), aside = way times the angle."""
    speed, sd = 2.4, (0.0076, 0.0018)
    shot = Shot((StoneStart("A", 0, 0, 0, speed),), PointMass(), Constant(MU), NoCurl(), R)
    out = sample(written_start(shot), 4000, sd)
    way = speed**2 / (2 * MU * GRAVITY)
    assert out["y"].mean() == pytest.approx(way, rel=0.001)
    assert out["y"].std() == pytest.approx(speed * sd[0] / (MU * GRAVITY), rel=0.05)
    assert out["x"].std() == pytest.approx(way * sd[1], rel=0.05)
    # The same throw, seen late on its way, spreads as much.
    gone = 20.0
    later = math.sqrt(speed**2 - 2 * MU * GRAVITY * gone)
    stone = replace(shot.stones[0], y=gone, vy=later)
    late = Start(replace(shot, stones=(stone,)), 0, release=gone)
    again = sample(late, 4000, sd)
    assert again["y"].std() == pytest.approx(out["y"].std(), rel=0.01)
    assert again["x"].std() == pytest.approx(out["x"].std(), rel=0.01)


def test_each_shot_that_it_may_be_is_thrown_as_often() -> None:
    """And each ends where it ends alone, whatever differs: states, laws, or the size."""
    shot = replace(HIT, bounds=None)
    first, *rest = shot.stones
    start = Start(
        shot,
        0,
        (
            replace(shot, stones=(replace(first, vy=-1.7, x=0.15), *rest)),
            replace(shot, impact=Frictional(0.7, 0.15, 0.45)),
            replace(shot, ice=Fit(0.002, 0.06, 0.007), radius=1.01 * R),
            replace(shot, curl=FCV1Curl(0.004, 0.02), ice=Penner(0.009)),
        ),
    )
    out = sample(start, 40, (0.0, 0.0))
    ends = {
        tuple(np.round(places.ravel(), 5))
        for _, group in out.groupby("sample")
        for places in [group[["x", "y"]].to_numpy()]
    }
    expected = []
    for other in start.others:
        there = simulate(other).rest
        expected.append(tuple(np.round([(there[n].x, there[n].y) for n in "ABC"], 5).ravel()))
    assert ends == set(expected)
    often = out[out["stone"] == "A"].round(5)[["x", "y"]].value_counts()
    assert set(often) == {10}
    assert sample(start, 5).equals(sample(start, 5))


def test_what_is_set_is_known_exactly_and_what_is_a_factor_is_not() -> None:
    shot = replace(HIT, bounds=None)
    first, *rest = shot.stones
    others = tuple(
        replace(
            shot,
            stones=(
                replace(first, vx=0.01 * k, vy=-1.6 - 0.02 * k, omega=0.5 + k),
                *rest,
            ),
            impact=Frictional(0.8 + 0.02 * k, 0.05),
            ice=Constant(MU + 0.001 * k),
        )
        for k in (-1, 1)
    )
    start = Start(shot, 0, others)
    set_to = changed(start, Changes(0.9, 0.012, Amount(2.0), Amount(-1.0)))
    for other in (set_to.shot, *set_to.others):
        stone = other.stones[0]
        assert math.hypot(stone.vx, stone.vy) == pytest.approx(2.0)
        assert (stone.omega, getattr(other.impact, "restitution", None)) == (-1.0, 0.9)
        assert float(other.ice.deceleration(1.0)) == pytest.approx(0.012 * GRAVITY)
    assert set_to.others[0].stones[0].vx != set_to.others[1].stones[0].vx
    times = changed(start, Changes(speed=Amount(1.1, True), spin=Amount(-1.0, True)))
    for now, before in zip(times.others, others, strict=True):
        assert now.stones[0].vy == pytest.approx(1.1 * before.stones[0].vy)
        assert now.stones[0].omega == -before.stones[0].omega


def test_what_is_given_need_not_be_assumed() -> None:
    names = ("restitution", "friction", "stone_friction", "spin of A", "spin of B")
    start = replace(written_start(HIT), assumed={name: f"{name} is not known" for name in names})
    left = changed(start, Changes(0.9, 0.012, spin=Amount(1.5))).assumed
    assert set(left) == {"stone_friction", "spin of B"}
    assert changed(start, Changes(spin=Amount(0.5, relative=True))).assumed == start.assumed


def test_odds_count() -> None:
    start = written_start(HIT)
    rows = [
        # In the house and nearest to the tee, B, then C; outside; hit or not.
        (0, "A", 5.0, 0.0, 1), (0, "B", 0.5, 0.0, 1), (0, "C", -1.0, -1.0, 0),
        (1, "A", 0.0, 9.0, 1), (1, "B", 3.0, 0.0, 1), (1, "C", -1.0, -1.0, 0),
    ]  # fmt: skip
    table = pd.DataFrame(rows, columns=["sample", "stone", "x", "y", "hits"]).assign(in_play=1)
    told = odds(table, start)
    assert [told[name].in_house for name in "ABC"] == [0.0, 0.5, 1.0]
    assert [told[name].shot_stone for name in "ABC"] == [0.0, 0.5, 0.5]
    assert [told[name].moved for name in "ABC"] == [1.0, 1.0, 0.0]
    assert (told["A"].x, told["A"].sd_x) == (2.5, 2.5)
    nowhere = replace(start, shot=replace(start.shot, bounds=None))
    assert {item.in_play for item in odds(table, nowhere).values()} == {None}
    table.loc[table["stone"] == "B", "in_play"] = 0
    told = odds(table, start)
    assert (told["B"].x, told["B"].sd_y, told["B"].in_play) == (None, None, 0.0)
    assert [told[name].shot_stone for name in "ABC"] == [0.0, 0.0, 1.0]
    once = odds(table[table["sample"] == 0], start)["A"]
    assert (once.x, once.sd_x, once.sd_y) == (5.0, None, None)
    pucks = replace(start, house=False)
    assert {(item.in_house, item.shot_stone) for item in odds(table, pucks).values()} == {
        (None,) * 2
    }


def test_a_measured_shot_is_played_on_a_sheet() -> None:
    start = measured_start(*measured())
    assert start.shot.bounds == Bounds(-1)
    fast = changed(start, Changes(speed=Amount(2.5, relative=True)))
    outcomes = sample(fast, 50)
    ends = odds(outcomes, fast)
    assert ends["B"].in_play < 0.1
    assert ends["B"].in_house <= ends["B"].in_play
    assert ends["C"].in_play > 0.7
    assert set(outcomes["in_play"]) == {0, 1}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (Changes(speed=Amount(9.0, relative=True)), "would be thrown at"),
        (Changes(spin=Amount(-100.0, relative=True)), "would turn at"),
    ],
)
def test_throws_that_nobody_can_make(changes: Changes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        changed(measured_start(*measured()), changes)
