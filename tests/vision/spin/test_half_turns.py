from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision.spin import handle
from vision.spin.align import ORDERS
from vision.spin.half_turns import unfolded


@given(st.floats(-3, 3), st.integers(4, 30), st.integers(0, 6), st.sampled_from([-2, -1, 1, 2]))
def test_half_turns_beside_a_gap_are_taken_out(
    spin: float, at: int, hidden: int, halves: int
) -> None:
    times = np.arange(40) / 25
    true = spin * times
    angles = true + np.pi * halves * (np.arange(40) >= at)
    angles[at : at + hidden] = np.nan
    told = np.isfinite(angles)
    out = unfolded(times, angles)
    assert np.array_equal(np.isfinite(out), told)
    assert np.abs(out - true)[told].max() < 1e-9


def test_the_spin_beside_a_gap_may_be_unsteady_or_unlike_on_either_side() -> None:
    times = np.arange(60) / 30
    true = np.where(times < 0.9, 1.2 * times, 1.08 - 1.5 * (times - 0.9))
    angles = true + 0.1 * np.sin(9 * times) + np.pi * (times > 1.0)
    angles[24:31] = np.nan
    out = unfolded(times, angles)
    assert np.nanmax(np.abs(out - true)) < 0.11


def beside_a_gap(count: int, wait: float) -> tuple[np.ndarray, np.ndarray]:
    """Times of pictures, the last before a gap at 0, and whether they are after it."""
    each = np.arange(count) / 25
    return np.concatenate([each - each[-1], wait + each]), np.repeat([False, True], count)


def test_spins_beside_a_gap_are_told_by_enough_pictures_and_by_no_more() -> None:
    times, late = beside_a_gap(4, 0.3)  # few
    fast = 3 * times
    times_two, late_two = beside_a_gap(2, 0.45)  # too few: one of them is off
    off = np.array([0.0, 0.2, 0, 0])
    many, late_many = beside_a_gap(20, 0.48)
    hit = 4 * np.sign(many - 0.24) * np.maximum(np.abs(many - 0.24) - 0.64, 0)  # .4 s away
    astray = np.zeros(40)
    astray[[18, 21]] = -0.9, 0.9  # one picture on either side shows something else
    for t, after, true in (
        (times, late, fast), (times_two, late_two, off), (many, late_many, hit),
        (many, late_many, astray),
    ):  # fmt: skip
        np.testing.assert_allclose(unfolded(t, true + np.pi * after), true, atol=1e-9)


@pytest.mark.parametrize("halves", [-1, 1])
def test_a_stone_turns_on_while_its_handle_is_long_unseen(halves: int) -> None:
    times, late = beside_a_gap(12, 1.0)
    true = -1.4 * times - 0.1 * times * late
    np.testing.assert_allclose(unfolded(times, true + np.pi * halves * late), true, atol=1e-9)


def test_what_stones_may_turn_is_left() -> None:
    times, late = beside_a_gap(20, 0.7)
    after_long = np.where(late, 1.8 + 4.3 * (times - 0.7), 0.0)  # a hit spun it out of sight
    assert np.array_equal(unfolded(times, after_long), after_long)
    few, _ = beside_a_gap(3, 4.0)
    noisy = -0.8 * few + np.array([-0.03, 0.0, 0.03] * 2)  # 3 rad astray over so long
    assert np.array_equal(unfolded(few, noisy), noisy)
    once, later = beside_a_gap(1, 0.7)  # one picture on either side tells no spin
    assert np.array_equal(unfolded(once, 3.0 * later), 3.0 * later)
    fast = 9.0 * np.arange(40) / 5  # steps of more than a quarter turn, all alike
    assert np.array_equal(unfolded(np.arange(40) / 5, fast), fast)
    no_half_turn = np.where(np.arange(40) < 20, 0.0, 2.2)  # something else went wrong there
    assert np.array_equal(unfolded(np.arange(40) / 25, no_half_turn), no_half_turn)


def test_few_or_no_angles_stay_as_they_are() -> None:
    for angles in (np.full(3, np.nan), np.array([np.nan, 1.0, np.nan]), np.array([0.0, 3.1])[:0]):
        assert np.array_equal(unfolded(np.arange(len(angles)) / 25, angles), angles, equal_nan=True)


def test_a_handle_found_again_the_wrong_way_round_is_put_right(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a bar alike at both ends the pictures themselves do not tell."""
    times, radii = np.arange(50) / 25, np.linspace(0.012, 0.09, 8)
    true = 1.4 * times
    bar = np.where(ORDERS % 2 == 0, np.exp(-((ORDERS / 6.0) ** 2)), 0.0)
    spectra = [
        np.repeat(bar * np.exp(-1j * ORDERS * turn), 24).reshape(-1, 8, 3).astype(np.complex64)
        for turn in true
    ]
    wrong = true + np.pi * (times > 0.9)
    monkeypatch.setattr(handle, "_followed", lambda *_: wrong)
    theta, _ = handle.handle_angles(times, spectra, radii, np.full(50, 0.0005))
    assert np.abs(theta - true).max() < 0.01
