from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic import Key, render_still
from curlshot.tests.helpers.vision.landmarks import PATH, SCENE, SIZE, truth
from curlshot.vision.camera_path.keyframe import Keyframe, keyframe
from curlshot.vision.camera_path.landmarks import Landmarks
from curlshot.vision.optics.pose import View, project
from curlshot.vision.optics.resection import solve_view


def keyed() -> Keyframe:
    """A keyframe of the first picture."""
    view, rig = truth(PATH, 0.0)
    return keyframe(0, render_still(SCENE, PATH, 0.0), view, rig, np.zeros((4, 4)))


def test_landmarks_are_recognised_where_the_camera_has_moved() -> None:
    (before, rig), (after, _) = truth(PATH, 0.0), truth(PATH, 4.0)
    one, two = (render_still(SCENE, PATH, t) for t in (0.0, 4.0))
    key = keyframe(0, one, before, rig, np.diag([1e-5, 1e-5, 1e-5, 1e-6]) ** 2)
    guess = View(after.vector + np.array([0.004, -0.004, 0.002, 0.005]))
    seen = Landmarks(key).find(two, guess, rig)
    assert seen is not None
    found = solve_view(seen.marks, guess, rig, SIZE, view_sd=np.full(4, np.inf)).view
    ice = np.array([[-1.0, 3.0], [0.0, 4.0], [1.0, 5.0]])
    there = [project(ice, v.vector, rig, SIZE) for v in (found, after)]
    assert np.linalg.norm(there[0] - there[1], axis=1).max() < 0.7
    assert seen.aside > 3.0


def test_landmarks_are_found_again_after_others_were_looked_for_turned_and_closer() -> None:
    near = replace(PATH, keys=(Key(0.0, -0.6, 3.6, 150, 0.2), Key(6.0, -0.6, 3.6, 150, 0.2)))
    key, cameras = keyed(), [(PATH, 0.0), (near, 0.0), (PATH, 0.0), (near, 0.0)]
    landmarks = Landmarks(key)
    for path, t in cameras:
        view, rig = truth(path, t)
        picture = render_still(SCENE, path, t)
        seen, fresh = (each.find(picture, view, rig) for each in (landmarks, Landmarks(key)))
        assert seen is not None and fresh is not None
        np.testing.assert_array_equal(seen.marks.along, fresh.marks.along)
        np.testing.assert_allclose(seen.marks.pixel, fresh.marks.pixel, atol=0.1)


def test_a_graphic_alone_is_no_scene() -> None:
    view, rig = truth(PATH, 0.0)
    key = keyframe(0, render_still(SCENE, PATH, 0.0), view, rig, np.zeros((4, 4)))
    blank = np.full((SIZE[1], SIZE[0], 3), 90, np.uint8)
    shown = render_still(SCENE, PATH, 0.0)[20:120, 30:300]
    blank[20:120, 30:300] = shown
    assert Landmarks(key).find(blank, view, rig) is None
