from __future__ import annotations

import cv2
import numpy as np

from curlshot.vision.video.flow import similarity

SIZE = (1280, 720)


def texture(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    grain = rng.integers(0, 256, (90, 160, 3), dtype=np.uint8)
    return np.asarray(cv2.resize(grain, SIZE, interpolation=cv2.INTER_CUBIC), np.uint8)


def test_motion_of_the_picture_is_measured() -> None:
    before = texture(1)
    c, s = 1.01 * np.cos(0.01), 1.01 * np.sin(0.01)
    true = np.array([[c, -s, 9.0], [s, c, -6.0]])
    after = cv2.warpAffine(before, true, SIZE, borderMode=cv2.BORDER_REFLECT)
    found = similarity(before, np.asarray(after, np.uint8))
    assert found is not None
    corners = np.array([[100.0, 100.0], [1100.0, 100.0], [1100.0, 600.0]])
    there = corners @ true[:, :2].T + true[:, 2]
    np.testing.assert_allclose(corners @ found[:, :2].T + found[:, 2], there, atol=0.5)


def test_another_scene_is_no_motion() -> None:
    assert similarity(texture(1), texture(2)) is None
