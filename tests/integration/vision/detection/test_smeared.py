from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.smeared import PATH, SCENES, VIEW, learned, smeared
from curlshot.tests.helpers.vision.stones import CAMERA
from curlshot.vision.detection.measure import measure_discs
from curlshot.vision.detection.rays import Look


@pytest.mark.parametrize("aside", [(0.0, 0.0), (0.004, 0.012), (-0.003, -0.012)])
def test_of_a_stone_that_is_known_to_move_the_place_is_that_of_mid_exposure(
    aside: tuple[float, float],
) -> None:
    place = PATH[1:2] + np.array(aside)
    look = Look(smeared(1), VIEW, place, (PATH[1] - PATH[0])[None])
    still = measure_discs([replace(look, drift=None)], learned(), STONE)
    moving = measure_discs([look], learned(), STONE)
    assert moving.swept.all() and not still.swept.any()
    assert np.hypot(*(moving.centre[0] - PATH[1])) < 0.0025
    assert moving.sd[0, 1] > still.sd[0, 1]
    assert np.isnan(moving.light).all()


@pytest.mark.parametrize("drift", [(-0.01, -0.1), (0.07, 0.05)])
def test_a_fast_stone_that_is_sharp_is_told_by_its_edges(drift: tuple[float, float]) -> None:
    picture = render_still(SCENES[4][1], CAMERA)
    look = Look(picture, VIEW, PATH[1:2], np.array([drift]))
    still = measure_discs([replace(look, drift=None)], learned(), STONE)
    moving = measure_discs([look], learned(), STONE)
    assert moving.swept.all()
    np.testing.assert_array_equal(moving.centre, still.centre)
    np.testing.assert_array_equal(moving.sd, still.sd)
    assert np.isfinite(moving.light).all()


def test_a_fast_stone_that_is_half_covered_is_left_to_its_edges() -> None:
    covered = smeared(1).copy()
    x, y = VIEW.project(PATH[1:2], STONE.cap_height)[0].astype(int).tolist()
    covered[y - 50 : y + 50, x : x + 50] = (60, 90, 60)
    look = Look(covered, VIEW, PATH[1:2], (PATH[1] - PATH[0])[None])
    assert not measure_discs([look], learned(), STONE).swept.any()
