from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.tests.helpers.vision.reliefs import ANGLE, RADII, bar, cap, seen
from curlshot.vision.detection.relief import contrast, contrast_turned, without_handle


@pytest.mark.parametrize("order", [2, 3, 4, 5])
def test_a_wave_around_the_centre_has_its_root_mean_square(order: int) -> None:
    wave = cap(40 * np.cos(order * ANGLE))
    assert contrast(wave, wave) == pytest.approx(40 / np.sqrt(2), rel=0.01)


@pytest.mark.parametrize("order", [1, 7, 12])
def test_light_from_one_side_and_grain_are_no_handle(order: int) -> None:
    wave = cap(40 * np.cos(order * ANGLE))
    assert contrast(wave, wave) < 0.5


@pytest.mark.parametrize("turn", [0.0, 0.05, 1.0])
def test_a_handle_shows_however_it_lies_and_a_rim_does_not(turn: float) -> None:
    one, other = cap(bar(30, turn)), cap(bar(30, turn + 0.1))
    assert contrast(one, other) == pytest.approx(contrast(one, one), rel=0.1)
    assert contrast(one, one) > 5
    rim = cap(np.where(RADII / STONE.cap_radius > 0.75, 40 * np.cos(2 * ANGLE), 0.0))
    assert contrast(rim, rim) < 0.5


def test_noise_that_is_anew_in_each_picture_is_not_shared() -> None:
    noisy = [cap(bar(0), 8.0, seed) for seed in range(41)]
    assert np.median([contrast(a, a) for a in noisy]) > 2
    assert abs(np.median([contrast(*pair) for pair in pairwise(noisy)])) < 1


def test_opposites_share_less_than_nothing() -> None:
    wave = 40 * np.cos(2 * ANGLE)
    assert contrast(cap(wave), cap(-wave)) == pytest.approx(-40 / np.sqrt(2), rel=0.01)


@pytest.mark.parametrize("turn", [0.0, 0.7, 1.6, 3.1])
def test_a_turn_between_two_pictures_may_leave_their_contrast(turn: float) -> None:
    one, other = cap(bar(30)), cap(bar(30, turn))
    assert contrast_turned(one, other) == pytest.approx(contrast(one, one), rel=0.05)


def test_noise_adds_half_as_much_to_turned_pictures_as_to_one() -> None:
    noisy = [cap(bar(0), 8.0, seed) for seed in range(41)]
    own = np.median([contrast(a, a) for a in noisy])
    assert np.median([contrast_turned(*pair) for pair in pairwise(noisy)]) < 0.55 * own


def test_one_picture_tells_paint_beside_stones_and_not_where_no_handle_is_seen() -> None:
    stones, paint = [seen(30.0), seen(-15.0)], [seen(0.0), seen(2.0)]
    assert without_handle([*stones, *paint]).tolist() == [False, False, True, True]
    assert not without_handle(paint).any()
    assert not without_handle([*stones, seen(0.0, pixel=0.02)]).any()  # too coarse to show it
    assert not without_handle([*stones, paint[0]._replace(spectrum=None)]).any()
    assert without_handle([]).shape == (0,)


def test_beside_clear_handles_a_faint_one_is_still_one() -> None:
    """Real stones have 2.8 and more, squares of a house that is painted as a tartan 0.9 to 1.8."""
    assert without_handle([seen(30.0), seen(8.0), seen(5.0)]).tolist() == [False, False, True]
