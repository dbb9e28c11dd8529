from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from data.errors import InputError
from data.results import Estimate, Friction, SimulatedHit, SimulationScore
from data.sheet import GRAVITY
from physics.ice import Constant, Penner
from physics.prediction.start import HOG_TO_TEE, measured_start, speed_before
from physics.simulator.simulate import simulate
from physics.simulator.simulation import StoneStart
from tests.physics.measured import HIT, MU, R, measured


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


def test_an_unseen_spin_is_what_fits_the_whole_shot_or_any() -> None:
    tracks, results = measured()
    blind = tracks.assign(omega=np.where(tracks["stone"] == "C", 0.0, np.nan), sd_omega=np.nan)
    (hit,) = results.collisions
    turning = replace(hit.before["A"], omega=-1.7, sd_omega=0.2)
    simulated = SimulatedHit(hit.t, 0.001, hit.stones, {**hit.before, "A": turning}, hit.after)
    scores = {"frictional": SimulationScore(0.001, hits=(simulated,))}
    for given, spin, sd, how in (
        (scores, -1.7, 0.2, "by what fits the whole shot"),
        ({}, 0.0, 1.5 * math.sqrt(2), "assumed"),
    ):
        start = measured_start(blind, replace(results, simulations=given))
        a, b, c = start.shot.stones
        assert (a.omega, start.sd[0, 4]) == pytest.approx((spin, sd))
        assert [b.omega, c.omega, *start.sd[1:, 4]] == [0.0] * 4
        (said,) = start.assumed
        assert said.startswith("spin of A not seen") and said.endswith(how)


def test_without_a_sheet_no_stone_leaves_it() -> None:
    tracks, results = measured()
    start = measured_start(tracks, replace(results, sheet=False))
    assert (start.shot.bounds, start.house, start.release) == (None, False, 0.0)


@pytest.mark.parametrize("way", [-2.0, 0.0, 5.0, 60.0])
def test_speed_along_the_way_has_its_closed_form(way: float) -> None:
    speed = np.array([0.9, 1.5, 2.6])
    expected = np.sqrt(np.maximum(speed**2 + 2 * MU * GRAVITY * way, 0))
    assert speed_before(speed, way, Constant(MU)) == pytest.approx(expected, abs=1e-9)
    root = speed_before(speed, way, Penner())
    expected = np.maximum(speed**2.5 + 2.5 * 0.008 * GRAVITY * way, 0) ** 0.4
    assert root == pytest.approx(expected, abs=1e-5)


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
