from __future__ import annotations

import numpy as np
import pytest

from curlshot.synthetic import Key, render_still
from curlshot.synthetic.camera import CameraPath
from curlshot.tests.helpers.vision.landmarks import SCENE, SIZE, truth
from curlshot.vision.camera_path.leap import leapt
from curlshot.vision.optics.pose import project

HIGH = (0.0, 0.0, 9.0)
BEFORE = CameraPath(SIZE, HIGH, (Key(0.0, 0.0, 0.3, 120),))


@pytest.mark.parametrize("aim", [(1.5, 0.3), (-0.9, 1.3), (0.0, -0.9)])
def test_a_view_turns_as_far_as_the_picture_has_moved(aim: tuple[float, float]) -> None:
    after = CameraPath(SIZE, HIGH, (Key(0.0, *aim, 120),))
    (view, rig), (there, _) = truth(BEFORE, 0.0), truth(after, 0.0)
    one, two = (render_still(SCENE, path, 0.0) for path in (BEFORE, after))
    found = leapt(one, two, view, rig)
    assert found is not None
    middle = np.array([0.5 * np.array(aim) + (0.0, 0.15)])
    pixels = [project(middle, v.vector, rig, SIZE)[0] for v in (view, found, there)]
    assert np.linalg.norm(pixels[2] - pixels[0]) > 100
    assert np.linalg.norm(pixels[2] - pixels[1]) < 15


def test_another_scene_tells_no_turn() -> None:
    view, rig = truth(BEFORE, 0.0)
    noise = np.random.default_rng(0).integers(0, 256, (18, 32, 3)).astype(np.uint8)
    other = np.repeat(np.repeat(noise, 40, axis=0), 40, axis=1)
    assert leapt(render_still(SCENE, BEFORE, 0.0), other, view, rig) is None


def test_bare_ice_tells_no_turn() -> None:
    view, rig = truth(BEFORE, 0.0)
    one = render_still(SCENE, BEFORE, 0.0)
    bare = np.full_like(one, 230)
    assert leapt(bare, one, view, rig) is None
