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
