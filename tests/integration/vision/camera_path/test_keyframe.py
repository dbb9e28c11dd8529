from __future__ import annotations

import numpy as np

from curlshot.synthetic import render_still
from curlshot.tests.helpers.vision.landmarks import PATH, SCENE, truth
from curlshot.vision.camera_path.keyframe import keyframe


def test_uncertainty_grows_from_keyframe_to_keyframe() -> None:
    view, rig = truth(PATH, 0.0)
    image = render_still(SCENE, PATH, 0.0)
    cov = np.diag([1e-4, 1e-4, 1e-4, 1e-4]) ** 2
    first = keyframe(0, image, view, rig, cov)
    assert 0.0005 < first.drift < 0.005
    assert keyframe(0, image, view, rig, cov, 0.01).drift > 0.01
