from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.data.sheet import GRAVITY
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant
from curlshot.physics.impact import Frictional, PointMass
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, States, StoneStart

R = 0.145
PLAY = Bounds()
SIDE, BACK, HOG = PLAY.half_width - R, PLAY.back_line + R, PLAY.hog_line - R


def straight(*stones: StoneStart, bounds: Bounds | None = PLAY) -> Simulation:
    """Constant friction, no curl."""
    return simulate(Shot(stones, PointMass(1.0), Constant(), NoCurl(), R, bounds))


@settings(deadline=None)
@given(st.floats(0.3, 4.0), st.floats(0.0, math.pi))
def test_a_stone_leaves_where_it_crosses_a_line(speed: float, angle: float) -> None:
    a = Constant().friction * GRAVITY
    ways = {
        SIDE / abs(math.cos(angle)) if math.cos(angle) else math.inf,
        BACK / math.sin(angle) if math.sin(angle) else math.inf,
    }
    way = min(ways)
    stone = StoneStart("A", 0, 0, speed * math.cos(angle), speed * math.sin(angle))
    sim = straight(stone)
    left = speed**2 - 2 * a * way
    if abs(left) < 1e-6:
        return
    if left < 0:
        assert sim.gone == {}
        assert sim.rest["A"].in_play
        return
    assert sim.gone["A"] == pytest.approx((speed - math.sqrt(left)) / a, abs=1e-7)
    rest = sim.rest["A"]
    assert not rest.in_play
    assert (rest.x, rest.y) == pytest.approx(
        (way * math.cos(angle), way * math.sin(angle)), abs=1e-7
    )
    times = np.linspace(0, 2 * sim.gone["A"], 11)
    assert sim.sample(times)["t"].max() <= sim.gone["A"]


def test_a_stone_that_is_gone_hits_nothing() -> None:
    behind = StoneStart("B", 0, BACK + 1.0)
    thrown = StoneStart("A", 0, -1, 0, 3.0)
    assert straight(thrown, behind, bounds=None).hits != ()
    assert straight(thrown, behind).hits == ()
    # What lies out of play is left there.
    assert straight(thrown, behind).rest["B"].in_play


def test_play_goes_either_way() -> None:
    up, down = StoneStart("A", 0, 0, 0, 1.0), StoneStart("B", 1, 0, 0, -1.0)
    assert set(straight(up, down).gone) == {"A"}
    assert set(straight(up, down, bounds=Bounds(play=-1)).gone) == {"B"}


def test_a_stone_short_of_the_hog_line_is_taken_away_unless_it_hit_another() -> None:
    short = StoneStart("A", 0, -HOG - 2, 0, 0.5)
    sim = straight(short)
    assert sim.gone["A"] == pytest.approx(0.5 / (Constant().friction * GRAVITY))
    assert sim.rest["A"].y < -HOG
    guard = StoneStart("B", 0, -HOG - 1.2)
    assert straight(short, guard).hits != ()
    assert straight(short, guard).gone == {}
    assert straight(StoneStart("A", 0, -HOG - 1, 0, 0.8)).gone == {}


@pytest.mark.parametrize("play", [1, -1])
def test_each_variant_leaves_as_it_does_alone(play: int) -> None:
    stones = (
        StoneStart("A", 0.1, -7.5 * play, 0.05, 2.6 * play, 1.0),
        *(
            StoneStart(name, 0.5 * (k % 4 - 1.5) + 0.1, (0.5 * (k // 4) - 0.2) * play)
            for k, name in enumerate("BCDEFGHI")
        ),
        StoneStart("G1", 0.6, -7.2 * play),
    )
    shot = Shot(stones, Frictional(0.83, 0.2), FCV1(), FCV1Curl(), R, Bounds(play))
    count = 60
    rng = np.random.default_rng(1)
    states = States.of(shot, count)
    states.x[:, 0] += rng.normal(0, 0.3, count)
    states.vy[:, 0] *= rng.uniform(0.3, 1.4, count)
    out = simulate_many(shot, states)
    gone = 0
    for k in range(count):
        columns = {key: value[k] for key, value in vars(states).items()}
        own = tuple(
            StoneStart(
                stone.name, *(float(columns[key][i]) for key in ("x", "y", "vx", "vy", "omega"))
            )
            for i, stone in enumerate(stones)
        )
        alone = simulate(Shot(own, shot.impact, shot.ice, shot.curl, R, shot.bounds))
        rests = list(alone.rest.values())
        assert out.in_play[k].tolist() == [rest.in_play for rest in rests]
        places = np.array([(rest.x, rest.y) for rest in rests])
        np.testing.assert_allclose(np.stack([out.x[k], out.y[k]], -1), places, atol=1e-6)
        gone += len(alone.gone)
    assert gone > 20
