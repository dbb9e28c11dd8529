from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.physics.filter.stretch import (
    ANGLE_MEMORY,
    PLACE_MEMORY,
    SPIN_LOSS,
    Model,
    Stretch,
    drift,
    steps,
)

N = 21


def stretch(*, a: float = 0.1, speed: float = 1.0, stops: int = N, breaks: int = N) -> Stretch:
    """Up y from 0, at rest from row `stops` on, another motion from row `breaks` on."""
    t = np.arange(N) * 0.05
    rest = np.arange(N) >= stops
    rough = np.column_stack([np.zeros(N), np.where(rest, 0.0, speed - a * t)])
    return Stretch(
        t, np.zeros((N, 3)), np.full((N, 3), 0.01), np.zeros((N, 3)),
        (np.arange(N) >= breaks).astype(int), rest, rest, rough, Model(a, 0.02),
    )  # fmt: skip


def test_the_ice_slows_a_stone_as_it_is_known_to() -> None:
    moved = stretch()
    known = drift(moved, *steps(moved))
    t = moved.t
    assert known[:, 1] == pytest.approx(-0.5 * 0.1 * t**2, abs=1e-12)
    assert known[:, 3] == pytest.approx(-0.1 * t, abs=1e-12)
    assert np.all(known[:, [0, 2, 4, 5]] == 0)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_ice_takes_spin_and_more_of_a_slow_stone(sign: int) -> None:
    moved = stretch(a=0.9)
    turning = replace(moved, z=moved.z + sign * np.outer(1.5 * moved.t, [0, 0, 1]))
    known = drift(turning, *steps(turning))
    t = moved.t
    # What is lost at 1 - 0.9 t, m/s, put together in closed form.
    lost = SPIN_LOSS * np.log(1 / (1 - 0.9 * t)) / 0.9
    assert known[:17, 5] == pytest.approx(-sign * lost[:17], rel=0.1)
    angle = np.concatenate([[0], np.cumsum(0.5 * np.diff(t) * (known[1:, 5] + known[:-1, 5]))])
    assert known[:, 4] == pytest.approx(angle, abs=1e-12)


def test_no_more_spin_is_lost_than_there_is_and_none_at_rest() -> None:
    slow = stretch(speed=0.02, a=0.0, stops=15)
    slow = replace(slow, z=slow.z + np.outer(0.01 * slow.t, [0, 0, 1]))
    known = drift(slow, *steps(slow))
    assert known[10, 5] == pytest.approx(-0.01, rel=1e-6)
    assert np.all(known[15:, 5] == 0)
    unseen = replace(slow, z=np.full_like(slow.z, np.nan))
    assert np.all(drift(unseen, *steps(unseen))[:, 4:] == 0)


def test_a_stone_at_rest_goes_nowhere() -> None:
    along, turning = steps(stretch(stops=10))
    for way in (along, turning):
        assert np.all(way.reach[10:] == 0)
        assert np.all(way.keep[9:] == 0)
        assert np.all(way.q00[9:] == 0)


def test_a_stone_stopped_dead_may_have_gone_on_for_any_part_of_the_step() -> None:
    along, _ = steps(stretch(stops=10, breaks=10, a=0.0))
    # Uniform over what it would have gone at 1 m/s in a step.
    assert np.sqrt(along.q00[9]) == pytest.approx(0.05 / np.sqrt(12), rel=0.03)
    assert np.all(along.q00[10:] == 0)


def test_what_lasts_fades_with_time() -> None:
    along, turning = steps(stretch())
    assert along.fade == pytest.approx(np.exp(-0.05 / PLACE_MEMORY))
    assert turning.fade == pytest.approx(np.exp(-0.05 / ANGLE_MEMORY))


def test_slow_stones_may_lose_their_spin_faster() -> None:
    fast, slow = (steps(stretch(speed=speed, a=0.0))[1].q11 for speed in (2.0, 0.2))
    assert slow == pytest.approx(100 * fast)


def test_a_motion_that_changes_little_changes_its_spin_little() -> None:
    calm = stretch(breaks=10)
    rough = calm.speed.copy()
    rough[10:] += [0.5, 0.0]
    pushed = Stretch(**{**vars(calm), "speed": rough})
    plain, little, much = (
        float(np.sqrt(steps(each)[1].q11[9])) for each in (stretch(), calm, pushed)
    )
    assert plain < little < 0.1
    assert much > 1.0


def test_slow_stones_may_be_slowed_more() -> None:
    fast, slow = (steps(stretch(speed=speed, a=0.0))[0].q11 for speed in (2.0, 0.1))
    assert np.all(slow > 2 * fast)
