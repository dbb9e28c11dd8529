"""What tests of watch share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    scene_of,
)
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.picture import Image

AT_REST = [(0.3, 0.2, RED), (-0.8, 1.0, YELLOW), (0.9, -0.6, RED)]


def picture(places: list[tuple[float, float, tuple[int, int, int]]]) -> Image:
    return np.asarray(render_still(scene_of(places), CAMERA), np.uint8)


def lasting(camera: Camera) -> list[Camera]:
    """The camera of more frames than are looked at."""
    return [replace(camera, frame=frame) for frame in range(200)]
