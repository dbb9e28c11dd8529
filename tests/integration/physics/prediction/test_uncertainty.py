from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.estimate import estimate
from curlshot.physics.ice import Constant
from curlshot.physics.impact import Frictional, PointMass
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.traces import shared_correlation
from curlshot.physics.prediction.replay import simulate_measured
from curlshot.physics.prediction.uncertainty import (
    InitialUncertainty,
    drawn,
    path_spread,
    simulated,
    simulated_hits,
)
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, StoneStart
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch

MU, G = 0.0109, 9.81
CERTAIN = np.zeros(5)


def draws(shot: Shot, doubt: InitialUncertainty, count: int) -> list[Simulation]:
    rng = np.random.default_rng(0)
    return simulated(drawn(shot, doubt, rng) for _ in range(count))


def test_a_glide_is_as_uncertain_as_its_closed_form_says() -> None:
    # Stopping distance v² / (2 μ g): 2 sd(v) / v and sd(μ) / μ of it.
    shot = Shot((StoneStart("A", 0.0, 0.0, 0.0, 2.0),), ice=Constant(MU), curl=NoCurl())
    way = 2.0**2 / (2 * MU * G)
    for doubt, relative in (
        (InitialUncertainty({"A": np.array([0, 0, 0, 0.01, 0])}, {}), 2 * 0.01 / 2.0),
        (InitialUncertainty({"A": CERTAIN}, {}, friction=0.01), 0.01),
    ):
        end = path_spread(draws(shot, doubt, 200), np.array([0.0, 30.0])).iloc[-1]
        assert end["sd_y"] == pytest.approx(way * relative, rel=0.15)
        assert end["sd_x"] == pytest.approx(0.0, abs=1e-9)


def test_the_turn_of_a_path_is_drawn_where_it_was_measured() -> None:
    stone = StoneStart("A", 0.0, 0.0, 0.0, 2.0, 1.0)
    shot = Shot((stone,), ice=Constant(MU), curl=FCV1Curl(turn=0.008, loss=0.0))
    runs = draws(shot, InitialUncertainty({"A": CERTAIN}, {}, turn=0.001), 300)
    bent, straight = (
        simulate(replace(shot, curl=FCV1Curl(turn=turn, loss=0.0))).rest["A"].x
        for turn in (0.009, 0.008)
    )
    end = path_spread(runs, np.array([0.0, 30.0])).iloc[-1]
    assert end["sd_x"] == pytest.approx(abs(bent - straight), rel=0.15)


def test_a_head_on_hit_passes_on_what_is_not_known_of_restitution_and_speed() -> None:
    stones = (StoneStart("A", 0.0, -1.0, 0.0, 2.0), StoneStart("B", 0.0, 0.0))
    shot = Shot(stones, PointMass(0.8), Constant(MU), NoCurl())
    states = {"A": np.array([0, 0, 0, 0.01, 0]), "B": CERTAIN}
    runs = draws(shot, InitialUncertainty(states, {}, restitution=0.05), 300)
    (hit,) = simulated_hits(simulate(shot), runs, start=1.5)
    assert hit.stones == ("A", "B")
    assert hit.t > 1.5
    speed, after = hit.before["A"].vy, hit.after["B"]
    assert after.vy == pytest.approx(0.9 * speed)
    assert after.sd_vy == pytest.approx(np.hypot(0.05 / 2 * speed, 0.9 * 0.01), rel=0.15)
    assert after.sd_vx == pytest.approx(0.0, abs=1e-9)


def test_a_hit_that_hardly_ever_happens_has_no_errors() -> None:
    stones = (StoneStart("A", 0.29, -1.0, 0.0, 1.0), StoneStart("B", 0.0, 0.0))
    shot = Shot(stones, Frictional(0.8, 0.1), Constant(MU), NoCurl())
    aside = {"A": np.array([0.5, 0, 0, 0, 0]), "B": CERTAIN}
    (hit,) = simulated_hits(simulate(shot), draws(shot, InitialUncertainty(aside, {}), 40), 0.0)
    assert hit.stderr_t is None
    assert hit.after["B"].sd_vx is None


def test_nothing_doubtful_has_no_spread_and_the_same_seed_gives_the_same() -> None:
    stones = (StoneStart("A", 0.1, -1.0, 0.0, 1.0, 0.5), StoneStart("B", 0.0, 0.0))
    shot = Shot(stones, Frictional(0.8, 0.1), Constant(MU), NoCurl())
    none = InitialUncertainty({"A": CERTAIN, "B": CERTAIN}, {})
    times = np.linspace(0.0, 3.0, 7)
    table = path_spread(draws(shot, none, 5), times)
    assert len(table) == 14
    assert table.filter(like="sd_").to_numpy().max() < 1e-12
    some = InitialUncertainty({"A": np.full(5, 0.01), "B": CERTAIN}, {}, 0.05, 0.02, 0.01)
    one, two = (path_spread(draws(shot, some, 8), times) for _ in range(2))
    assert one.equals(two)
    assert path_spread([], times).empty


def test_errors_of_a_simulated_shot_mean_what_they_say() -> None:
    motion = hit_motion(1.5, 0.1, before=1.2, after=3.0, stone_friction=0.1)
    rng, pulls = np.random.default_rng(18), []
    for _ in range(5):
        seen = watch(motion, rng, sd=0.004, fps=25)
        hits = detect_hits(seen, RADIUS)
        tracks = smooth(seen, hits, radius=RADIUS)
        found = estimate(seen, hits, radius=RADIUS)
        again = simulate_measured(tracks, found, radius=RADIUS)
        last = again.samples["frictional"].groupby("stone").last()
        truth = motion.at(np.array([last["t"].iloc[0]]))[0][:, :2]
        pulls += (
            ((last[["x", "y"]] - truth) / last[["sd_x", "sd_y"]].to_numpy()).to_numpy().tolist()
        )
        (hit,) = again.scores["frictional"].hits
        for name, true in zip("AB", motion.hits[0].after, strict=True):
            state = hit.after[name]
            off = np.array([state.vx, state.vy]) - true[:2]
            pulls.append((off / [state.sd_vx, state.sd_vy]).tolist())
    # The eight of one draw hang together: hardly more than ten are independent.
    assert 0.4 < np.std(pulls) < 1.4
    assert np.mean(np.abs(pulls) < 2) > 0.85


def test_what_two_places_share_moves_both_and_leaves_the_hit_as_it_is() -> None:
    """A common error of 5 mm is one of 5 mm at the end; what is not is that times the lever."""
    stones = (StoneStart("A", 0.1, -0.3, 0.0, 1.0), StoneStart("B", 0.0, 0.0))
    shot = Shot(stones, PointMass(0.8), Constant(MU), NoCurl())
    size = np.array([0.005, 0.005, 0, 0, 0])
    states, common = {"A": size, "B": size}, {name: np.full(2, 0.005) for name in "AB"}
    spread = {}
    for name, doubt in (
        ("apart", InitialUncertainty(states, {})),
        ("shared", InitialUncertainty(states, {}, shared=common)),
    ):
        first, last = (
            path_spread(draws(shot, doubt, 200), np.array([0.0, 3.0])).query("t == @t")["sd_x"]
            for t in (0.0, 3.0)
        )
        assert first.to_numpy() == pytest.approx([0.005, 0.005], rel=0.2)
        spread[name] = last.to_numpy()
    assert np.all(spread["apart"] > 0.03)
    alone = np.sqrt(1 - shared_correlation(np.array([[0.1, -0.3], [0.0, 0.0]]))[0, 1])
    assert spread["shared"] == pytest.approx(alone * spread["apart"], rel=0.2)
    assert alone < 0.5


def test_the_size_of_the_stones_is_drawn_too() -> None:
    stones = (StoneStart("A", 0.1, -0.6, 0.0, 1.0), StoneStart("B", 0.0, 0.0))
    shot = Shot(stones, PointMass(0.8), Constant(MU), NoCurl())
    none = {"A": CERTAIN, "B": CERTAIN}
    (hit,) = simulated_hits(
        simulate(shot), draws(shot, InitialUncertainty(none, {}, size=0.01), 200), 0.0
    )
    # 2 R at 1 m/s on the way to B.
    assert hit.stderr_t == pytest.approx(0.01 * 2 * RADIUS / 0.94, rel=0.3)
