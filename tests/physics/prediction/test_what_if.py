from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from data.errors import InputError
from data.sheet import GRAVITY
from physics.curl import FCV1Curl, NoCurl
from physics.ice import FCV1, Constant
from physics.impact import Frictional, PointMass
from physics.prediction.start import Start, measured_start, written_start
from physics.prediction.what_if import Amount, Changes, changed, odds, sample
from physics.simulator.bounds import Bounds
from physics.simulator.simulate import simulate
from physics.simulator.simulation import Shot, StoneStart
from tests.physics.measured import HIT, MU, R, measured


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
    with pytest.raises(InputError, match="A would begin off the sheet"):
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
    late = Start(
        replace(shot, stones=(stone,)), 0, np.zeros((1, 5)), np.zeros((1, 1)), release=gone
    )
    again = sample(late, 4000, sd)
    assert again["y"].std() == pytest.approx(out["y"].std(), rel=0.01)
    assert again["x"].std() == pytest.approx(out["x"].std(), rel=0.01)


def test_measured_uncertainties_spread_the_outcome() -> None:
    shot = Shot((StoneStart("A", 0, 0, 0, 2.0),), PointMass(), Constant(MU), NoCurl(), R)
    way = 2.0**2 / (2 * MU * GRAVITY)
    start = Start(shot, 0, np.zeros((1, 5)), np.zeros((1, 1)), sd_friction=0.02)
    out = sample(start, 4000, (0.0, 0.0))
    assert out["y"].std() == pytest.approx(0.02 * way, rel=0.05)
    assert out["x"].std() == pytest.approx(0.0, abs=1e-12)
    speed = Start(shot, 0, np.array([[0, 0, 0, 0.01, 0]]), np.zeros((1, 1)))
    out = sample(speed, 4000, (0.0, 0.0))
    assert out["y"].std() == pytest.approx(2.0 * 0.01 / (MU * GRAVITY), rel=0.05)


def test_restitution_is_drawn_where_it_is_not_known() -> None:
    start = replace(written_start(replace(HIT, bounds=None)), sd_restitution=0.03)
    out = sample(start, 600, (0.0, 0.0))
    b = out[out["stone"] == "B"]
    (hit,) = simulate(HIT).hits
    # v' = (1 + e) u / 2 and way = v'² / (2 μ g), so d(way) / way = 2 de / (1 + e).
    way = np.hypot(b["x"] - 0.1, b["y"] - 0.5)
    assert way.std() / way.mean() == pytest.approx(2 * 0.03 / 1.8, rel=0.1)
    assert hit.stones == ("A", "B")
    assert sample(start, 5).equals(sample(start, 5))


def test_friction_between_stones_and_curl_are_drawn_where_they_are_not_known() -> None:
    glancing = replace(HIT, impact=Frictional(0.8, 0.05), bounds=None)
    start = replace(written_start(glancing), sd_stone_friction=0.01)
    b = sample(start, 600, (0.0, 0.0)).query("stone == 'B'")
    (hit,) = simulate(glancing).hits
    # A rub μ_s turns B's velocity by atan μ_s.
    away = np.arctan2(b["y"] - hit.before["B"].y, b["x"] - hit.before["B"].x)
    assert away.std() == pytest.approx(0.01, rel=0.1)
    stone = StoneStart("A", 0, 0, 0, 2.0, 1.0)
    alone = Shot((stone,), ice=Constant(MU), curl=FCV1Curl(turn=0.008, loss=0.0))
    out = sample(
        Start(alone, 0, np.zeros((1, 5)), np.zeros((1, 1)), sd_turn=0.001), 2000, (0.0, 0.0)
    )
    bent, straight = (
        simulate(replace(alone, curl=FCV1Curl(turn=turn, loss=0.0))).rest["A"].x
        for turn in (0.009, 0.008)
    )
    assert out["x"].std() == pytest.approx(abs(bent - straight), rel=0.05)


def test_what_places_share_moves_all_stones_together() -> None:
    tracks, results = measured()
    start = measured_start(tracks, replace(results, shared_error=0.003))
    a, b, c = (tracks[tracks["stone"] == name].iloc[0] for name in "ABC")
    # Known to 4 mm, 3 of them alike: exp(-2 d²) for distances d in metres.
    apart = math.dist((b["x"], b["y"]), (c["x"], c["y"]))
    assert start.together[1, 2] == pytest.approx(0.003**2 * math.exp(-2 * apart**2))
    assert start.together[0, 0] == pytest.approx(0.003**2)
    assert start.sd[:, :2] == pytest.approx(math.sqrt(0.004**2 - 0.003**2))
    assert a["y"] != start.shot.stones[0].y  # taken back, and its error with it
    alone = measured_start(tracks, replace(results, shared_error=None))
    assert not alone.together.any()
    wide, narrow = (
        sample(s, 600, (0.0, 0.0)).query("stone == 'B'")[["x", "y"]].std().sum()
        for s in (alone, start)
    )
    assert narrow < 0.9 * wide


def test_the_distance_at_contact_is_drawn_where_it_was_measured() -> None:
    start = replace(written_start(replace(HIT, bounds=None)), sd_size=0.01)
    b = sample(start, 600, (0.0, 0.0)).query("stone == 'B'")
    smaller, larger = (
        simulate(replace(HIT, radius=R * factor, bounds=None)).rest["B"] for factor in (0.99, 1.01)
    )
    assert b["x"].std() == pytest.approx(abs(larger.x - smaller.x) / 2, rel=0.1)


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
    assert ends["C"].in_play > 0.8
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
