from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic import render_still
from curlshot.tests.helpers.vision.landmarks import PATH, SCENE, SIZE, truth
from curlshot.vision.camera_path.keyframe import keyframe
from curlshot.vision.camera_path.landmarks import Landmarks
from curlshot.vision.optics.pose import camera


def test_another_scene_is_not_recognised() -> None:
    view, rig = truth(PATH, 0.0)
    key = keyframe(0, render_still(SCENE, PATH, 0.0), view, rig, np.zeros((4, 4)))
    noise = np.random.default_rng(0).integers(0, 256, (90, 160, 3)).astype(np.uint8)
    other = np.repeat(np.repeat(noise, 8, axis=0), 8, axis=1)
    assert Landmarks(key).find(other, view, rig) is None


def test_corners_in_one_row_tell_no_scene_and_stop_nothing() -> None:
    view, rig = truth(PATH, 0.0)
    image = render_still(SCENE, PATH, 0.0)
    key = keyframe(0, image, view, rig, np.zeros((4, 4)))
    corners = np.column_stack([np.arange(150.0, 350.0, 10), np.full(20, 176.0)])
    row = replace(key, ice=camera(view, rig, SIZE).ice(2 * corners + 0.5), corners=corners)
    assert Landmarks(row).find(image, view, rig) is None
