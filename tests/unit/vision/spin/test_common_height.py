from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.tests.helpers.vision.handles import RADII, SURE, patch
from curlshot.vision.spin.angles import angles_in_parts
from curlshot.vision.spin.common_height import common_height, turned_widely
from curlshot.vision.spin.handle import DOUBT, HandleAngles, cap_spectrum
from curlshot.vision.video.disk_cache import Cached

TIMES = np.arange(80) / 25
ASIDE = (0.0, 0.035)
"""Where a grip seen at 50 degrees lies in a picture unrolled at the height of the cap, m."""


def told(theta: float, *unlike: float) -> HandleAngles:
    angles = np.linspace(0.0, theta, 50)
    return HandleAngles(
        angles, 0 * angles, np.zeros((len(angles), 2)), np.array(unlike), frozenset({0})
    )


def pictures(true: NDArray[np.float64], seed: int) -> list[Cached[NDArray[np.complex64]]]:
    """A grip at its own height, its picture unsure; at that of the cap aside."""
    rng = np.random.default_rng(seed)
    kept = []
    for turn in true:
        grip, cap = patch(turn).astype(float), patch(turn, shift=ASIDE)
        both = np.concatenate([grip, cap], axis=1)
        both[:, : len(RADII)] += rng.normal(0, 8, grip.shape)
        kept.append(Cached(cap_spectrum(np.clip(both, 0, 255).astype(np.uint8), RADII)))
    return kept


def spin_off(angles: HandleAngles, true: NDArray[np.float64], turning: slice) -> float:
    off = np.polyfit(TIMES[turning], (angles.theta - true)[turning], 1)[0]
    return float(abs(off))


def test_a_stone_that_turned_widely_tells_the_height_for_one_that_hardly_did() -> None:
    sd, turning = np.full(len(TIMES), SURE), slice(45, None)
    wide, little = 0.4 + 2.0 * TIMES, 2.0 + 0.6 * np.maximum(TIMES - 1.8, 0)
    thrown, struck = pictures(wide, 1), pictures(little, 2)
    own = [angles_in_parts(TIMES, shown, RADII, sd) for shown in (thrown, struck)]
    assert [each.heights for each in own] == [{0}, {1}]
    assert common_height(own) == 0
    again = angles_in_parts(TIMES, struck, RADII, sd, height=0)
    assert spin_off(own[1], little, turning) > 0.05
    assert spin_off(again, little, turning) < 0.02


@pytest.mark.parametrize("most", [1000, 30])
def test_a_height_may_be_given(most: int) -> None:
    sd, true = np.full(len(TIMES), SURE), 0.4 + 2.0 * TIMES
    shown = pictures(true, 3)
    rings = len(RADII)
    for height in (0, 1):
        part = [Cached(each.get()[:, height * rings : (height + 1) * rings]) for each in shown]
        given = angles_in_parts(TIMES, shown, RADII, sd, most, height=height)
        np.testing.assert_array_equal(
            given.theta, angles_in_parts(TIMES, part, RADII, sd, most).theta
        )


def test_parts_of_a_long_track_tell_the_height_together() -> None:
    sd, true = np.full(len(TIMES), SURE), 0.4 + 2.0 * TIMES
    whole, parts = (angles_in_parts(TIMES, pictures(true, 3), RADII, sd, n) for n in (80, 40))
    assert whole.heights == parts.heights == {0}
    assert whole.unlike[1] > 2 * whole.unlike[0] > 0
    assert parts.unlike[1] > 2 * parts.unlike[0] > 0


def test_nothing_is_told_where_no_stone_turned_or_heights_are_about_as_good() -> None:
    assert common_height([]) is None
    assert common_height([told(0.8, 1.0, 9.0)]) is None
    assert common_height([told(4.0, 1.0, 0.9 * DOUBT), told(0.8, 1.0, 9.0)]) is None
    assert common_height([told(4.0, 1.0, 1.1 * DOUBT)]) == 0
    assert common_height([told(-4.0, 9.0, 1.0), told(4.0, 1.0, 3.0)]) == 1
    assert common_height([told(4.0, 1.0, 3.0), told(-4.0, 9.0, 1.0)]) == 1
    assert common_height([told(4.0, 1.0)]) is None  # a disc that is flat


def test_a_stone_without_angles_did_not_turn() -> None:
    assert turned_widely(told(1.6, 1.0, 1.0)) and not turned_widely(told(1.4, 1.0, 1.0))
    assert not turned_widely(told(np.nan, 1.0, 1.0))
