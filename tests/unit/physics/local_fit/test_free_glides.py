from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.free_glides import are_free, is_pushed
from curlshot.physics.local_fit.segments import Piece
from curlshot.tests.helpers.physics.free_glides import FPS, seen, told
from curlshot.tests.helpers.physics.watch import Floats


def by_turns(slowing: Floats, speed: float, each: float = 0.75) -> Floats:
    """A way up y whose slowing, m/s², changes from one stretch to the next."""
    t = np.arange(0.0, each * len(slowing), 1 / FPS)
    v = speed - np.cumsum(slowing[(t // each).astype(int)]) / FPS
    return np.column_stack([0 * t, np.cumsum(v) / FPS])


@pytest.mark.parametrize(
    ("slowing", "aside", "sd", "sd_aside", "so"),
    [
        (0.1, 0.0, 0.01, 0.01, False),
        (-0.15, 0.0, 0.01, 0.01, False),
        (-0.25, 0.0, 0.01, 0.01, True),
        (-0.25, 0.0, 0.03, 0.01, False),
        (3.0, 0.0, 0.01, 0.01, False),
        (0.1, 0.25, 0.01, 0.01, True),
        (0.1, -0.25, 0.01, 0.01, True),
        (0.1, 0.25, 0.01, 0.03, False),
    ],
)
def test_what_no_ice_gives_is_a_push(
    slowing: float, aside: float, sd: float, sd_aside: float, so: bool
) -> None:
    assert is_pushed(slowing, aside, sd, sd_aside) == so


def pieces(*stops: bool) -> list[Piece]:
    return [
        Piece("A", float(k), k + 1.0, np.arange(30), stops=stop) for k, stop in enumerate(stops)
    ]


def test_what_follows_one_push_is_free_and_between_two_nothing() -> None:
    row = pieces(False, False, False, False)
    assert are_free(row, (), {}).all()
    assert are_free(row, {1}, {}).tolist() == [False, False, True, True]
    assert not are_free(row, {0, 2}, {}).any()
    rests = pieces(False, True, False, False)
    assert are_free(rests, {2, 3}, {}).tolist() == [True, True, False, False]
    other = [*row[:2], Piece("B", 0.0, 1.0, np.arange(30))]
    assert are_free(other, {0, 1}, {}).tolist() == [False, False, True]
    # A hit, or a rest whose piece has been left out, begins anew.
    struck = [*row[:2], Piece("A", 2.0, 3.0, np.arange(30), opens=0)]
    assert are_free(struck, {0, 1}, {}).tolist() == [False, False, True]
    later = [*row[:2], Piece("A", 5.0, 6.0, np.arange(30))]
    assert are_free(later, {0, 1}, {}).tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("apart", "count", "so"), [(0.4, 8, False), (0.4, 4, True), (1.0, 8, True)]
)
def test_a_motion_that_changes_all_the_time_is_led(apart: float, count: int, so: bool) -> None:
    piece = Piece("A", -np.inf, np.inf, np.arange(90))
    assert are_free([piece], (), {"A": [k * apart for k in range(count)]}).tolist() == [so]
    assert are_free([piece], (), {"B": [0.1 * k for k in range(9)]}).all()
    times = {"A": [k * apart for k in range(count)]}
    rests = [Piece("A", k * apart, (k + 0.9) * apart, np.arange(9)) for k in range(count)]
    assert are_free(rests, (), times).all() == so  # however it is cut


def test_the_slowed_halves_of_a_swing_are_no_friction() -> None:
    found = told(by_turns(np.array([0.5, -0.5] * 4), 1.0))
    assert found.friction.value is None


def test_a_stone_that_is_thrown_in_view_tells_friction_afterwards() -> None:
    found = told(by_turns(np.array([-1.0, 0.107, 0.107, 0.107, 0.107]), 0.4))
    assert found.friction.value == pytest.approx(0.0109, abs=0.0005)
    assert any("S0 is apparently pushed or carried between 0.0" in t for t in found.warnings)


@pytest.mark.parametrize(("each", "so"), [(0.8, True), (0.4, False)])
def test_a_stone_that_is_led_tells_no_friction(each: float, so: bool) -> None:
    t = np.arange(0.0, 12 * each, 1 / FPS)
    velocity = np.column_stack([np.where((t // each) % 2, 0.4, -0.4), np.full(len(t), 0.6)])
    found = told(np.cumsum(velocity, axis=0) / FPS)
    assert (found.friction.value is not None) == so


def test_frictions_that_differ_are_a_mean_if_that_tells_something() -> None:
    wood = told(*(by_turns(np.array([9.81 * mu]), 1.5, 0.5) for mu in (0.27, 0.33)))
    assert wood.friction.value == pytest.approx(0.30, abs=0.01)
    assert "the value is a mean" in str(wood.friction_doubt)
    vague = told(*(by_turns(np.array([a]), 1.5, 1.0) for a in (1.0, -0.15, 0.1, -0.1)))
    assert len(vague.glides) == 4
    assert vague.friction.value is None
    assert "is too uncertain" in str(vague.friction_doubt)


def test_what_gains_speed_all_the_way_is_followed() -> None:
    tracks = smooth(seen(by_turns(np.array([-0.8]), 0.2, 1.2)), (), radius=0.04)
    off = tracks["vy"] - (0.2 + 0.8 * tracks["t"])
    assert np.sqrt(np.mean(off**2)) < 0.03
    assert np.sqrt(np.mean((off / tracks["sd_vy"]) ** 2)) < 1.5
