from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.data.results import Estimate
from curlshot.data.tracks import check_detections
from curlshot.physics.local_fit.traces import traces
from curlshot.physics.shot_fit.shot_model import ObservedShot, SpinSeen, Unknown, curl, ice, penner

RADIUS = 0.1455
VALUES = {
    "restitution": 0.8, "stone_friction": 0.05, "friction": 0.01,
    "A.x": 0.05, "A.y": -1.0, "A.vy": 1.5, "A.omega": 1.0,
    "B.x": 0.0, "B.y": 0.0, "C.x": 0.0, "C.y": 0.35,
}  # fmt: skip


def observed(hits: tuple[tuple[str, str], ...] = (), times: tuple[float, ...] = ()) -> ObservedShot:
    """Three stones in a row, seen where `VALUES` puts them, from 2 s on."""
    t = 2.0 + np.arange(60) / 30
    laws = tuple(Unknown(name, value) for name, value in VALUES.items())
    empty = check_detections(
        pd.concat([pd.DataFrame({"stone": s, "t": t, "x": 0.0, "y": 0.0}) for s in "ABC"])
    )
    bare = ObservedShot(traces(empty), 2.0, laws, radius=RADIUS)
    run = bare.replay(VALUES).sample(t - 2.0)
    seen = run[["stone", "x", "y"]].assign(t=2.0 + run["t"], sd_x=0.002, sd_y=0.002)
    spins = (SpinSeen("A", 2.1, 0.9, 0.05),)
    return ObservedShot(traces(check_detections(seen)), 2.0, laws, spins, hits, times, RADIUS)


@pytest.mark.parametrize(
    ("place", "share", "sd"),
    [(0.0, None, 0.0), (1e-6, None, 0.002), (0.0015, None, 0.0025), (0.0015, 0.5, 0.00075)],
)
def test_caps_are_in_the_middle_to_what_places_share_and_some_of_their_size(
    place: float, share: float | None, sd: float
) -> None:
    shot = replace(observed(), off_centre=share)
    trace = shot.traces["A"]
    known = replace(trace, sd_place=np.full_like(trace.xy, place))
    assert shot.sd_off_centre(known) == pytest.approx(sd, rel=0.02)


def test_the_right_values_leave_nothing() -> None:
    shot = observed()
    simulation = shot.replay(VALUES)
    assert [hit.stones for hit in simulation.hits] == [("A", "B"), ("B", "C")]
    assert max(float(np.abs(run).max()) for run in shot.residuals(simulation)) < 1e-6
    omega = simulation.state("A", 0.1).omega
    assert shot.spin_residuals(simulation) == pytest.approx([(0.9 - omega) / 0.05])


def test_a_hit_that_was_not_seen_is_named() -> None:
    run = observed().replay(VALUES)
    first, second = (hit.t + 2.0 for hit in run.hits)
    one, two = ("A", "B"), ("B", "C")
    assert observed((one, two), (first, second)).first_other_hit(run) is None
    assert observed((one,), (first,)).first_other_hit(run) == (pytest.approx(second), "B and C")
    late = observed((one, two, ("A", "C")), (first, second, 3.5)).first_other_hit(run)
    assert late == (3.5, "A and C")


@pytest.mark.parametrize(("speed", "named"), [(0.01, False), (0.05, True)])
def test_a_hit_too_soft_to_be_seen_need_not_have_been(speed: float, named: bool) -> None:
    """As where a stone goes on behind the one that it has hit, and touches it again."""
    run = observed().replay(VALUES)
    pairs, times = zip(*((hit.stones, hit.t + 2.0) for hit in run.hits), strict=True)
    last = run.hits[-1]
    first, second = last.stones
    nx, ny = last.normal
    behind = replace(last.after[second], vx=speed * nx, vy=speed * ny)
    before = {first: behind, second: replace(behind, vx=0.0, vy=0.0)}
    again = replace(last, t=last.t + 0.2, before=before)
    assert again.closing_speed == pytest.approx(speed)
    other = observed(pairs, times).first_other_hit(replace(run, hits=(*run.hits, again)))
    assert other == ((pytest.approx(again.t + 2.0), "B and C") if named else None)


def test_what_was_seen_before_a_time() -> None:
    shot = observed((("A", "B"), ("B", "C")), (2.5, 3.0)).until(2.8)
    assert shot.hits == (("A", "B"),)
    assert shot.end < 2.8
    assert len(shot.unknowns) == len(VALUES)
    assert not observed().until(2.05).spins


@pytest.mark.parametrize("slope", [0.0, 0.002])
def test_friction_is_that_at_1_m_s(slope: float) -> None:
    values = {"friction": 0.009, "slope": slope, "v_c": 0.05}
    for law in (ice(values), penner(values)):
        assert float(law.deceleration(1.0)) == pytest.approx(0.009 * 9.81, rel=1e-3)
    slow, fast = ice(values).deceleration(np.array([0.3, 2.0]))
    assert (slow > fast) == (slope > 0)


def test_without_turn_paths_are_straight() -> None:
    assert float(curl({"turn": 0.0}).turn_rate(1.0)) == 0.0
    assert float(curl({"turn": 0.005}).turn_rate(1.0)) == pytest.approx(0.005)


def test_an_unknown_knows_its_stone() -> None:
    assert Unknown("A.vx", 0.0).stone == "A"
    assert Unknown("stone.one.x", 0.0).stone == "stone.one"
    assert Unknown("friction", 0.01, prior=Estimate(0.01, 0.003)).stone is None


def test_a_spin_is_expected_of_stones_whose_spin_nobody_saw_and_curl_to_its_side() -> None:
    shot = observed()
    shot = replace(shot, unknowns=(*shot.unknowns, Unknown("turn", 0.0, -0.1, 0.1)))
    blind = {u.name: u for u in replace(shot, spins=()).spinning(Estimate(-1.5, 1.0)).unknowns}
    spin, turn = blind.pop("A.omega"), blind.pop("turn")
    assert (spin.guess, spin.prior) == (-1.5, Estimate(-1.5, 1.0))
    assert (turn.low, turn.high) == (0.0, 0.1)
    assert [*blind.values()] == [u for u in shot.unknowns if u.name not in ("A.omega", "turn")]
    assert shot.spinning(Estimate(-1.5, 1.0)).unknowns == shot.unknowns
