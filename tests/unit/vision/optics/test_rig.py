from __future__ import annotations

import math

import numpy as np
import pytest

from curlshot.vision.optics.rig import (
    ANYWHERE,
    BACK_Y,
    HOG_Y,
    K1,
    K1_BEND,
    K1_ZOOM,
    K2,
    OVERHEAD,
    POSITION,
    R4,
    R8,
    RIG_SIZE,
    SIDE_L,
    SIDE_R,
    WIDE,
    distortion,
    start_rig,
    zoom,
)

SIZE = (1280, 720)


@pytest.mark.parametrize("prior", [OVERHEAD, ANYWHERE, WIDE])
def test_a_prior_says_something_of_each_number(prior) -> None:
    assert prior.mean.shape == prior.sd.shape == (RIG_SIZE,)
    assert (prior.sd > 0).all()
    # Measured on stills of fourteen events: 1.207 to 1.224 m and 0.606 to 0.628 m.
    for edge, low, high in ((R8, 1.207, 1.224), (R4, 0.606, 0.628)):
        off = np.abs(np.array([low, high]) - prior.mean[edge]) / prior.sd[edge]
        assert (off < 2.5).all()
    assert prior.mean[SIDE_L] == -prior.mean[SIDE_R]
    assert prior.mean[BACK_Y] < 0 < prior.mean[HOG_Y]


def test_cameras_of_broadcasts_are_within_the_prior() -> None:
    """They hang 6 to 11 m above the ice, within 0.5 m of plumb over the tee."""
    middle, sd = OVERHEAD.mean[POSITION], OVERHEAD.sd[POSITION]
    for place in ([0.5, 0.5, 6.0], [-0.5, 0.5, 11.0]):
        assert (np.abs(place - middle) < 2.0 * sd).all()


def test_the_first_radial_term_goes_with_the_zoom() -> None:
    rig = start_rig(OVERHEAD)
    rig[[K1, K1_ZOOM, K1_BEND, K2]] = -0.05, 0.02, 0.005, 0.01
    wide, long = math.log(2560.0), math.log(2 * 2560.0)
    assert zoom(wide, SIZE) == pytest.approx(0.0)
    assert distortion(rig, wide, SIZE) == pytest.approx((-0.05, 0.01))
    twice = -0.05 + 0.02 * math.log(2) + 0.005 * math.log(2) ** 2
    assert distortion(rig, long, SIZE) == pytest.approx((twice, 0.01))


def test_a_wide_lens_over_a_house_upside_down_may_be_anywhere() -> None:
    """Its lens and its lines stay; where it is does not."""
    down = WIDE.downwards()
    assert down.mean[BACK_Y] == -WIDE.mean[BACK_Y] > 0 > down.mean[HOG_Y] == -WIDE.mean[HOG_Y]
    free = down.at_height(6.5).anywhere()
    own = [K1, K2, BACK_Y, HOG_Y]
    np.testing.assert_array_equal(free.mean[own], down.mean[own])
    np.testing.assert_array_equal(free.sd[own], down.sd[own])
    assert free.height == free.mean[POSITION][2] == 6.5
    np.testing.assert_array_equal(down.anywhere().sd[POSITION], ANYWHERE.sd[POSITION])
    np.testing.assert_array_equal(WIDE.mean[POSITION], down.mean[POSITION])


def test_a_start_does_not_change_the_prior() -> None:
    before = OVERHEAD.mean.copy()
    rig = start_rig(OVERHEAD, (1.0, 2.0, 3.0))
    assert rig[POSITION].tolist() == [1.0, 2.0, 3.0]
    np.testing.assert_array_equal(rig[K1:], before[K1:])
    np.testing.assert_array_equal(OVERHEAD.mean, before)


def test_a_wide_lens_keeps_the_ends_and_what_somebody_says() -> None:
    known = OVERHEAD.downwards().at_height(5.2).wide(-0.2)
    assert known.mean[K1] == WIDE.mean[K1] and known.mean[K2] == pytest.approx(0.04)
    assert known.mean[HOG_Y] == -OVERHEAD.mean[HOG_Y]
    assert known.mean[POSITION][2] == known.height == 5.2
    assert OVERHEAD.wide(-0.2).mean[POSITION][2] == WIDE.mean[POSITION][2]
