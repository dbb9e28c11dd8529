"""Pictures of a stone that moves while the shutter is open."""

from __future__ import annotations

import numpy as np

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import CAMERA, RED, camera_of, scene_of
from curlshot.vision.detection.appearance import learn
from curlshot.vision.detection.stones import search_picture

PATH = np.array([[0.3, 1.7], [0.29, 1.6], [0.28, 1.5]])
SCENES = [[scene_of([(x, y, RED)]) for x, y in PATH + s * (PATH[1] - PATH[0])]
          for s in np.linspace(-0.3, 0.3, 9)]  # fmt: skip
VIEW = camera_of(CAMERA, SCENES[0][0])
PICTURES = [
    np.mean([render_still(scenes[k], CAMERA) for scenes in SCENES], axis=0).round().astype(np.uint8)
    for k in range(3)
]
LEARNED = learn(search_picture(render_still(SCENES[4][1], CAMERA), VIEW).stones)
