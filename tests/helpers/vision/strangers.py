"""What tests of strangers share."""

from __future__ import annotations

import numpy as np

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.synthetic.scene import Colour, Scene
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    camera_of,
    scene_of,
)  # fmt: skip
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import FOLLOWING
from curlshot.vision.detection.strangers import strangers

BLACK, WHITE, DULL = (32, 30, 30), (232, 234, 234), (77, 77, 77)
MAROON, SLATE = (84, 76, 124), (124, 92, 78)
PLACES = [(0.3, 0.2), (-0.35, 0.3), (1.4, 0.6), (0.1, 2.4)]


def painted(*caps: Colour) -> Scene:
    return scene_of([(x, y, cap) for (x, y), cap in zip(PLACES, caps, strict=True)])


def seen(
    scene: Scene, known: list[tuple[float, float]] | None = None, contrast: float = 1.0
) -> tuple[Detection, ...]:
    image = (255 - contrast * (255 - np.asarray(render_still(scene, CAMERA), float))).astype(
        np.uint8
    )
    places = np.array(known or []).reshape(-1, 2)
    (found,), _ = strangers([Look(image, camera_of(CAMERA, scene), places)], STONE, FOLLOWING)
    return found.stones
