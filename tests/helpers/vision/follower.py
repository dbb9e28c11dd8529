"""What tests of follower share."""

from __future__ import annotations

import numpy as np

from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.association.follower import StoneView
from curlshot.vision.video.frame import Frame

Places = list[tuple[float, float]]
CAPS = (RED, YELLOW, RED)
START: Places = [(0.3, 0.2), (-0.8, 1.0), (0.9, -0.6)]


def view(places: Places, index: int) -> StoneView:
    scene = scene_of([(x, y, cap) for (x, y), cap in zip(places, CAPS, strict=False)])
    image = np.asarray(render_still(scene, CAMERA), np.uint8)
    return StoneView(Frame(index, index / 10, image), camera_of(CAMERA, scene))


def seen(views: list[StoneView], true: list[Places]) -> np.ndarray:
    """Distance of the nearest detection to each true place, m, shape (views, stones)."""
    return np.array(
        [
            [np.hypot(*(shown.places - place).T).min() for place in places]
            for shown, places in zip(views, true, strict=True)
        ]
    )
