from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.half_turns import CLOSE, error, pictures
from curlshot.vision.spin.half_turns import unfolded


def test_a_hit_changes_a_spin_and_what_covers_a_cap_for_a_moment_does_not() -> None:
    times = np.arange(90) / 30
    true = np.where(times < 1.5, 1.2 * times, 1.8 - 2.0 * (times - 1.5))
    seen = pictures(true)
    angles = true.copy()
    covered = slice(20, 24)  # a broom turned by itself
    seen[covered] = pictures(np.linspace(1.0, 4.0, 4))
    angles[covered] = true[19] + np.linspace(0.1, 0.6, 4)
    angles[24:] += np.pi
    out = unfolded(times, seen, angles)
    assert error(np.delete(out, np.arange(19, 25)), np.delete(true, np.arange(19, 25))) < CLOSE


def test_light_that_has_a_handle_look_the_other_way_round_turns_no_stone() -> None:
    times = np.arange(75) / 25
    true = -1.5 * times
    out = unfolded(times, pictures(true, lit=0.6), true + np.pi * (times > 1.0))
    assert error(out, true) < CLOSE


def test_a_stone_turns_on_while_its_handle_is_long_unseen() -> None:
    each = np.arange(20) / 25
    times = np.concatenate([each, 1.8 + each])
    true = -1.4 * times
    for halves in (-1, 1):
        out = unfolded(times, pictures(true), true + np.pi * halves * (times > 1))
        assert error(out, true) < CLOSE


def test_a_disc_that_turns_faster_than_all_that_is_tried_is_left() -> None:
    times = np.arange(60) / 60
    fast = 16.0 * times
    assert np.array_equal(unfolded(times, pictures(fast), fast), fast)
    slower = 8.0 * times
    assert error(unfolded(times, pictures(slower), slower), slower) < CLOSE


def test_what_stones_may_turn_is_left() -> None:
    times = np.concatenate([np.arange(20) / 25, 1.46 + np.arange(20) / 25])
    hit = np.where(times > 1, 1.8 + 4.3 * (times - 1.46), 0.0)  # spun out of sight
    no_half_turn = np.where(np.arange(40) < 20, 0.0, 1.2)  # something else went wrong there
    for true in (hit, no_half_turn):
        assert np.array_equal(unfolded(times, pictures(true), true), true)


def test_few_or_no_angles_stay_as_they_are() -> None:
    for angles in (np.full(3, np.nan), np.array([np.nan, 1.0, np.nan]), np.array([0.0, 3.1])[:0]):
        seen = pictures(np.zeros(len(angles)))
        same = unfolded(np.arange(len(angles)) / 25, seen, angles)
        assert np.array_equal(same, angles, equal_nan=True)
