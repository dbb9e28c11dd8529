from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.synthetic.camera import tilted_camera
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import CAMERA, YELLOW, camera_of, scene_of
from curlshot.tests.helpers.vision.stones import RED as SCARLET
from curlshot.vision.detection.glance import glance


@pytest.mark.parametrize("share", [1.0, 0.4, 0.2])
def test_stones_are_found_in_dim_pictures_as_in_bright_ones(share: float) -> None:
    places = [(0.3, 0.2), (-0.8, 1.0), (0.9, -0.6), (-0.2, -1.4)]
    scene = scene_of(
        [(*place, colour) for place, colour in zip(places, [SCARLET, YELLOW] * 2, strict=True)]
    )
    picture = np.asarray(render_still(scene, CAMERA) * share, np.uint8)
    (found,) = glance([(picture, camera_of(CAMERA, scene))])
    seen = np.array([(stone.x, stone.y) for stone in found.stones])
    assert len(seen) == len(places)
    np.testing.assert_allclose(
        seen[np.lexsort(seen.T)], sorted(places, key=lambda p: p[::-1]), atol=0.004
    )


def test_red_caps_of_a_recording_whose_tones_are_linear_are_found() -> None:
    """Dark red ones beside granite that is nearly black: one of three was not."""
    red = (30, 20, 130)
    places = [(0.3, 0.2, red), (-0.8, 1.0, YELLOW), (0.2, -1.5, red), (-1.5, 0.2, red)]
    scene, path = scene_of(places), tilted_camera(np.radians(45), height=5.5, px_per_m=100.0)
    image = np.asarray(render_still(scene, path, supersample=2), np.uint8)
    dark = np.round(255 * (image / 255) ** 2.2).astype(np.uint8)
    coded = cv2.imdecode(cv2.imencode(".jpg", dark, [cv2.IMWRITE_JPEG_QUALITY, 90])[1], 1)
    (found,) = glance([(np.asarray(coded, np.uint8), camera_of(path, scene))])
    assert len(found.stones) == len(places)
