from __future__ import annotations

import numpy as np
import pytest

from data.sheet import STONE
from tests.synthetic.clip import render_still
from tests.vision.test_stones import CAMERA, RED, YELLOW, camera_of, scene_of
from vision.appearance import any_stone
from vision.seek import seek, seek_about
from vision.stones import plain_disc

PLACES = np.array([[0.3, 1.9], [-0.45, 0.3], [1.25, 0.1]])
SCENE = scene_of([(x, y, cap) for (x, y), cap in zip(PLACES, (RED, YELLOW, RED), strict=True)])
PICTURE = np.asarray(render_still(SCENE, CAMERA), np.uint8)
VIEW = camera_of(CAMERA, SCENE)
ALL = (-2.0, 2.0, -1.5, 3.0)


@pytest.mark.parametrize("radius_px", [6.5, 11.6])
def test_the_strongest_places_are_those_of_stones(radius_px: float) -> None:
    found = seek(PICTURE, VIEW, None, STONE, ALL, radius_px=radius_px, least=0.45)
    assert found.appearance is not None
    apart = np.hypot(*(found.places[:3, None] - PLACES).transpose(2, 0, 1))
    assert apart.min(0).max() < 0.3 * STONE.radius
    far = np.hypot(*(found.places[:, None] - found.places).transpose(2, 0, 1))
    assert (far + 9 * np.eye(len(far))).min() > STONE.radius


def test_no_place_is_given_where_the_ice_is_not_in_the_picture() -> None:
    found = seek(PICTURE, VIEW, None, STONE, (40, 42, 0, 2), radius_px=8.0, least=0.4)
    assert found.places.shape == (0, 2)


@pytest.mark.parametrize("away", [(0.03, 0.0), (-0.02, 0.04), (0.0, -0.045)])
def test_a_stone_is_found_near_where_it_is_expected(away: tuple[float, float]) -> None:
    about = seek_about(
        PICTURE, VIEW, PLACES + np.array(away), any_stone(), STONE, radius_px=6.5, reach=0.35
    )
    assert np.hypot(*(about - PLACES).T).max() < 0.015


def test_plain_discs_answer_by_their_rim() -> None:
    found = seek(PICTURE, VIEW, None, plain_disc(STONE.radius), ALL, radius_px=11.6, least=0.45)
    apart = np.hypot(*(found.places[:, None] - PLACES).transpose(2, 0, 1))
    assert apart.min(0).max() < 0.06
