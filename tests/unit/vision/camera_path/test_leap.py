from __future__ import annotations

import numpy as np

from curlshot.synthetic import Key, render_still
from curlshot.synthetic.camera import CameraPath
from curlshot.tests.helpers.vision.landmarks import SCENE, SIZE, truth
from curlshot.vision.camera_path.leap import leapt

HIGH = (0.0, 0.0, 9.0)
BEFORE = CameraPath(SIZE, HIGH, (Key(0.0, 0.0, 0.3, 120),))


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
