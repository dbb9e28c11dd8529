from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from data.errors import InputError
from data.results import Collision, Estimate, Friction, Input, MeasuredState, Results
from data.sheet import GRAVITY
from physics.bounds import Bounds
from physics.curl import FCV1Curl, NoCurl
from physics.ice import FCV1, Constant, Penner
from physics.impact import Frictional, PointMass
from physics.simulate import simulate
from physics.simulation import Shot, StoneStart
from physics.start import HOG_TO_TEE, Start, measured_start, speed_before, written_start
from physics.what_if import Amount, Changes, changed, odds, sample

R = 0.1455
MU = 0.0105
HIT = Shot(
    (StoneStart("A", 0.2, 3.0, 0.0, -1.6, 0.5), StoneStart("B", 0.1, 0.5), StoneStart("C", -1, -1)),
    Frictional(0.8, 0.05),
    Constant(MU),
    NoCurl(),
    R,
    Bounds(-1),
)


def measured(shot: Shot = HIT) -> tuple[pd.DataFrame, Results]:
    """Tracks and results of a shot with one hit, as a run would write them."""
    done = simulate(shot)
    (hit,) = done.hits
    tracks = done.sample(np.arange(0, 6, 0.04))
    for key in ("x", "y", "theta", "vx", "vy", "omega"):
        tracks[f"sd_{key}"] = 0.004
    tracks["seen"] = 1
    before, after = (
        {name: MeasuredState(s.x, s.y, s.vx, s.vy, s.omega) for name, s in side.items()}
        for side in (hit.before, hit.after)
    )
    collision = Collision(
        hit.t, 0.001, hit.stones, hit.normal, 0.8, 0.02, before, after,
        stone_friction=0.05, stderr_stone_friction=0.01,
    )  # fmt: skip
    results = Results(
        Input(("clip.mp4",), 25.0, 150, 6.0),
        Estimate(0.8, 0.02),
        Friction(MU, 0.0002),
        (collision,),
        radius=R,
    )
    return tracks, results


def test_an_unchanged_shot_ends_as_it_did() -> None:
    start = measured_start(*measured())
    assert start.shot.stones[start.thrown].name == "A"
    done, truth = simulate(start.shot), simulate(HIT)
    assert [hit.stones for hit in done.hits] == [("A", "B")]
    for name, rest in truth.rest.items():
        # The states are taken from the last frame, from where on nothing is estimated anew.
        assert (done.rest[name].x, done.rest[name].y) == pytest.approx((rest.x, rest.y), abs=1e-5)
    assert start.release == pytest.approx(HOG_TO_TEE - start.shot.stones[0].y, abs=1e-6)
    assert (start.sd[1:, 2:] == 0).all() and (start.sd[0] > 0).all()


def test_the_stone_is_not_taken_back_through_another() -> None:
    tracks, results = measured()
    guard = tracks[tracks["stone"] == "C"].assign(stone="G", x=0.25, y=1.3)
    start = measured_start(pd.concat([tracks, guard]), results)
    a, g = start.shot.stones[0], start.shot.stones[-1]
    assert math.dist((a.x, a.y), (g.x, g.y)) > 2 * R
    assert a.y < 1.3


def test_what_was_not_measured_is_assumed_aloud() -> None:
    tracks, results = measured()
    blind = replace(results, restitution=Estimate(), friction=Friction(), collisions=())
    start = measured_start(tracks, blind)
    assert len(start.assumed) == 3
    still = tracks.assign(vx=0.0, vy=0.0)
    with pytest.raises(InputError, match="no stone moves"):
        measured_start(still, results)


@pytest.mark.parametrize("way", [-2.0, 0.0, 5.0, 60.0])
def test_speed_along_the_way_has_its_closed_form(way: float) -> None:
    speed = np.array([0.9, 1.5, 2.6])
    expected = np.sqrt(np.maximum(speed**2 + 2 * MU * GRAVITY * way, 0))
    assert speed_before(speed, way, Constant(MU)) == pytest.approx(expected, abs=1e-9)
    root = speed_before(speed, way, Penner())
    expected = np.maximum(speed**2.5 + 2.5 * 0.008 * GRAVITY * way, 0) ** 0.4
    assert root == pytest.approx(expected, abs=1e-5)


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
    # Known to 4 mm, 3 of them alike: exp(-d² / 2) for distances d in metres.
    apart = math.dist((b["x"], b["y"]), (c["x"], c["y"]))
    assert start.together[1, 2] == pytest.approx(0.003**2 * math.exp(-(apart**2) / 2))
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
    table.loc[table["stone"] == "B", "in_play"] = 0
    told = odds(table, start)
    assert (told["B"].x, told["B"].sd_y, told["B"].in_play) == (None, None, 0.0)
    assert [told[name].shot_stone for name in "ABC"] == [0.0, 0.0, 1.0]


def test_all_stones_begin_at_one_time() -> None:
    """A stone that was last seen a while before the hit has glided on until then."""
    start = HIT.stones[0], StoneStart("B", 0.1, 0.5), StoneStart("C", 1.0, 0.0, 0.0, 0.9)
    shot = replace(HIT, stones=start)
    tracks, results = measured(shot)
    hit = results.collisions[0].t
    lost = (tracks["stone"] == "C") & (tracks["t"] > hit - 0.6)
    begun = measured_start(tracks[~lost].reset_index(drop=True), results).shot.stones[2]
    truth = simulate(shot).sample([tracks.loc[tracks["t"] < hit, "t"].max()])
    expected = truth.set_index("stone").loc["C"]
    assert (begun.x, begun.y) == pytest.approx((expected.x, expected.y), abs=1e-6)
    assert begun.vy == pytest.approx(expected.vy, abs=1e-6)


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


def test_stones_keep_their_masses_when_they_are_thrown_again() -> None:
    tracks, results = measured()
    heavy = measured_start(tracks, replace(results, masses={"A": 2.0, "B": 1.0, "C": 1.0})).shot
    assert [stone.mass for stone in heavy.stones] == [2.0, 1.0, 1.0]
    (hit,) = simulate(heavy).hits
    total = sum(mass * hit.after[name].vy for name, mass in (("A", 2.0), ("B", 1.0)))
    assert total == pytest.approx(2.0 * hit.before["A"].vy, rel=1e-9)


def test_what_is_assumed_is_not_known_exactly() -> None:
    tracks, results = measured()
    start = measured_start(tracks, replace(results, restitution=Estimate(), friction=Friction()))
    assert start.sd_restitution == pytest.approx(0.06)
    assert start.sd_friction == pytest.approx(0.003 / 0.0109)


def test_a_hit_of_two_moving_stones_is_met_again() -> None:
    shot = replace(
        HIT, stones=(StoneStart("A", -0.2, 3.0, 0.0, -1.8), StoneStart("B", -1.5, 1.05, 1.2, 0.1))
    )
    (hit,) = simulate(shot).hits
    start = measured_start(*measured(shot))
    (again,) = simulate(start.shot).hits
    assert again.stones == hit.stones
    for name, state in hit.after.items():
        assert again.after[name].vx == pytest.approx(state.vx, abs=0.02)
        assert again.after[name].vy == pytest.approx(state.vy, abs=0.02)
