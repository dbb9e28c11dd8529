from __future__ import annotations

import math
from dataclasses import astuple, replace

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.data.results import Estimate, Friction, SimulationScore
from curlshot.data.sheet import GRAVITY
from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import Constant, IceLaw, Penner
from curlshot.physics.impact import Frictional
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.prediction.start import BACK, HOG_TO_TEE, measured_start, speed_before
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.tests.helpers.physics.measured import HIT, MU, R, measured

CLOSE = replace(HIT.stones[0], y=1.1, vy=-1.5)
"""Some 0.3 m before its hit."""


def test_an_unchanged_shot_ends_as_it_did() -> None:
    tracks, results, ensemble = measured()
    start = measured_start(tracks, results, ensemble)
    assert start.shot.stones[start.thrown].name == "A"
    assert start.shot == HIT
    assert start.release == pytest.approx(HOG_TO_TEE - start.shot.stones[0].y, abs=1e-6)
    assert start.assumed == {}
    assert [replace(other, bounds=None) for other in start.others] == ensemble.others
    assert {other.bounds for other in start.others} == {Bounds(-1)}


def test_a_stone_that_was_seen_late_is_taken_back_to_have_room() -> None:
    shot = replace(HIT, stones=(CLOSE, *HIT.stones[1:]))
    tracks, results, ensemble = measured(shot)
    start = measured_start(tracks, results, ensemble)
    (hit,) = simulate(start.shot).hits
    (now,) = simulate(shot).hits
    begun, met = start.shot.stones[0], hit.before["A"]
    assert math.dist((begun.x, begun.y), (met.x, met.y)) == pytest.approx(BACK, abs=1e-6)
    assert (met.vx, met.vy) == pytest.approx((now.before["A"].vx, now.before["A"].vy), abs=1e-6)
    speeds = [other.stones[0].vy - begun.vy for other in start.others]
    assert speeds == pytest.approx([-0.002, -0.001, 0.001, 0.002], abs=2e-4)


@pytest.mark.parametrize("spin", [-1.5, 0.004, 1e-200, 0.0])
def test_a_stone_that_is_taken_back_comes_the_way_that_curls(spin: float) -> None:
    close = replace(CLOSE, vx=-0.1, vy=-0.6, omega=spin, theta=0.3)
    shot = replace(HIT, stones=(close, *HIT.stones[1:]), curl=FCV1Curl(0.03))
    start = measured_start(*measured(shot))
    assert start.shot.stones[0].y > close.y + 0.5
    (hit,), (now,) = simulate(start.shot).hits, simulate(shot).hits
    for stone in hit.stones:
        assert astuple(hit.after[stone]) == pytest.approx(astuple(now.after[stone]), abs=1e-6)
    ends, as_it_did = simulate(start.shot).rest["A"], simulate(shot).rest["A"]
    assert ends.theta == pytest.approx(as_it_did.theta, abs=1e-6)


def test_the_stone_is_not_taken_back_through_another() -> None:
    shot = replace(HIT, stones=(CLOSE, *HIT.stones[1:], StoneStart("G", 0.25, 1.65)))
    begun = measured_start(*measured(shot)).shot.stones
    assert math.dist((begun[0].x, begun[0].y), (begun[3].x, begun[3].y)) > 2 * R
    assert 1.1 <= begun[0].y < 1.4


def test_what_was_not_measured_is_assumed_aloud() -> None:
    tracks, results, ensemble = measured()
    blind = replace(results, restitution=Estimate(), friction=Friction(), collisions=())
    assumed = measured_start(tracks, blind, ensemble).assumed
    assert assumed == {
        "restitution": "restitution not measured: 0.8, as in the shot fit",
        "friction": f"friction not measured: {MU:.2g}, as in the shot fit",
        "stone_friction": "friction between the stones assumed to be 0.05",
    }
    usual = replace(ensemble, likely=replace(HIT, impact=Frictional(0.83), ice=Constant(0.0109)))
    assumed = measured_start(tracks, blind, usual).assumed
    assert assumed["restitution"] == "restitution not measured, 0.83 assumed"
    assert assumed["friction"] == "friction not measured, 0.0109 assumed"
    note = "friction between the stones not identifiable: they stick"
    blind = replace(blind, simulations={"frictional": SimulationScore(0.001, note=note)})
    assert measured_start(tracks, blind, ensemble).assumed["stone_friction"] == note


def test_where_nothing_moves_there_is_nothing_to_throw() -> None:
    tracks, results, ensemble = measured()
    still = replace(ensemble.likely, stones=ensemble.likely.stones[1:])
    with pytest.raises(InputError, match="no stone moves"):
        measured_start(tracks, results, replace(ensemble, likely=still))


@pytest.mark.parametrize(("likely", "said"), [(0.5, "0.5"), (-1e-28, "0")])
def test_an_unseen_spin_is_named_with_its_error(likely: float, said: str) -> None:
    tracks, results, ensemble = measured()
    blind = tracks.assign(omega=np.nan)
    shots = [
        replace(ensemble.likely, stones=(replace(HIT.stones[0], omega=spin), *HIT.stones[1:]))
        for spin in (likely, 0.3, 0.7)
    ]
    start = measured_start(blind, results, replace(ensemble, likely=shots[0], others=shots[1:]))
    assert start.assumed == {"spin of A": f"spin of A not measured: {said} ± 0.2 rad/s assumed"}


def test_without_a_sheet_no_stone_leaves_it() -> None:
    tracks, results, ensemble = measured()
    start = measured_start(tracks, replace(results, origin_at_tee=False), ensemble)
    assert (start.shot.bounds, start.house, start.release) == (None, False, 0.0)


@pytest.mark.parametrize("way", [-2.0, 0.0, 5.0, 60.0])
def test_speed_along_the_way_has_its_closed_form(way: float) -> None:
    speed = np.array([0.9, 1.5, 2.6])
    expected = np.sqrt(np.maximum(speed**2 + 2 * MU * GRAVITY * way, 0))
    assert speed_before(speed, way, Constant(MU)) == pytest.approx(expected, abs=1e-9)
    root = speed_before(speed, way, Penner())
    expected = np.maximum(speed**2.5 + 2.5 * 0.008 * GRAVITY * way, 0) ** 0.4
    assert root == pytest.approx(expected, abs=1e-5)


def test_a_hit_of_two_moving_stones_is_met_again() -> None:
    shot = replace(
        HIT, stones=(StoneStart("A", -0.2, 3.0, 0.0, -1.8), StoneStart("B", -1.5, 1.05, 1.2, 0.1))
    )
    assert measured_start(*measured(shot)).shot.stones == shot.stones


def test_every_shot_of_the_ensemble_is_taken_back_on_its_own_ice() -> None:
    shot = replace(HIT, stones=(CLOSE, *HIT.stones[1:]))
    tracks, results, ensemble = measured(shot)
    ices: list[IceLaw] = [Constant(0.009), Constant(0.012)]
    others: list[Shot] = [replace(ensemble.likely, ice=ice) for ice in ices]
    start = measured_start(tracks, results, Ensemble(0.0, ensemble.likely, others))
    speeds = [-other.stones[0].vy for other in start.others]
    way = start.shot.stones[0].y - CLOSE.y
    expected = [math.sqrt(1.5**2 + 2 * mu * GRAVITY * way) for mu in (0.009, 0.012)]
    assert speeds == pytest.approx(expected, abs=1e-9)
