"""Pictures of a stone that moves while the shutter is open."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import CAMERA, RED, camera_of, scene_of
from curlshot.vision.detection.appearance import Appearance, learn
from curlshot.vision.detection.stones import search_picture

PATH = np.array([[0.3, 1.7], [0.29, 1.6], [0.28, 1.5]])
SCENES = [[scene_of([(x, y, RED)]) for x, y in PATH + s * (PATH[1] - PATH[0])]
          for s in np.linspace(-0.3, 0.3, 9)]  # fmt: skip
VIEW = camera_of(CAMERA, SCENES[0][0])


@cache
def smeared(index: int) -> NDArray[np.uint8]:
    """The picture at a place of `PATH`: the mean of nine sharp ones."""
    sharp = [render_still(scenes[index], CAMERA) for scenes in SCENES]
    return np.mean(sharp, axis=0).round().astype(np.uint8)


@cache
def learned() -> Appearance | None:
    """What caps look like, learned of a sharp picture."""
    return learn(search_picture(render_still(SCENES[4][1], CAMERA), VIEW).stones)
