from __future__ import annotations

import numpy as np
import pytest

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.association.expected import look_beside, look_on_course
from curlshot.vision.detection.appearance import learn
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import search_picture


@pytest.mark.parametrize(
    ("aside", "apart"), [(0.01, 0.0005), (0.03, 0.0003), (0.045, 0.0003), (0.05, 0.00018)]
)
def test_where_a_stone_is_expected_has_no_say_in_where_it_is(aside: float, apart: float) -> None:
    scene = scene_of([(0.2, 0.9, RED), (-0.4, 0.2, YELLOW), (1.0, 1.6, RED)])
    image, camera = np.asarray(render_still(scene, CAMERA), np.uint8), camera_of(CAMERA, scene)
    learned = learn(search_picture(image, camera).stones)
    true = np.array([(stone.start.x, stone.start.y) for stone in scene.stones])
    found = {}
    for turn in range(4):
        way = aside * np.array([np.cos(np.pi * turn / 2), np.sin(np.pi * turn / 2)])
        look = Look(image, camera, true + way)
        beside = aside > 0.02
        seen = look_beside(look, [None] * 3, learned) if beside else look_on_course([look], learned)
        assert all(detection is not None for detection in seen)
        found[turn] = np.array([(s.x, s.y) for s in seen if s is not None])
    places = np.array(list(found.values()))
    assert np.abs(places - places.mean(0)).max() < apart
    assert np.abs(places - true).max() < 0.001
