from __future__ import annotations

import numpy as np

from curlshot.synthetic import render_still
from curlshot.tests.helpers.vision.landmarks import PATH, SCENE, SIZE, truth
from curlshot.vision.camera_path.keyframe import enlarged, keyframe, replaced, shrunk, small_of
from curlshot.vision.optics.paint import fixed
from curlshot.vision.optics.pose import View, camera, project


def test_points_of_a_keyframe_move_with_its_camera() -> None:
    view, rig = truth(PATH, 0.0)
    key = keyframe(3, render_still(SCENE, PATH, 0.0), view, rig, np.zeros((4, 4)))
    marks = fixed(key.ice, np.zeros_like(key.ice), 1.0)
    moved = View(view.vector + np.array([0.001, -0.002, 0.003, 0.002]))
    again = replaced(marks, key, camera(moved, rig, SIZE))
    there = np.stack([again.along, again.across], axis=-1)[: len(key.ice)]
    pixels = project(there, moved.vector, rig, SIZE)
    np.testing.assert_allclose(pixels, project(key.ice, view.vector, rig, SIZE), atol=1e-4)


def test_a_small_picture_shows_the_same_places() -> None:
    large = np.zeros((1080, 1920, 3), np.uint8)
    large[300:304, 700:704] = 200
    small = small_of(large)
    assert small.shape == (270, 480) and small[75, 175] == 200 and small.sum() == 200
    places = np.array([[701.5, 301.5]])  # the middle of the square
    np.testing.assert_allclose(shrunk(places, 4.0), [[175.0, 75.0]])
    np.testing.assert_allclose(enlarged(shrunk(places, 4.0), 4.0), places)
