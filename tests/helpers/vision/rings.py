"""What tests of rings share."""

from __future__ import annotations

import cv2
import numpy as np

W, H = 320, 180


def drawn(
    centre: tuple[float, float], twelve: float, squash: float = 1.0, lean_deg: float = 0.0
) -> np.ndarray:
    """Rings drawn four times as large and shrunk: smooth edges."""
    image = np.full((4 * H, 4 * W, 3), 235, np.uint8)
    middle = (round(4 * centre[0]), round(4 * centre[1]))
    for radius, colour in ((1.829, (60, 40, 190)), (1.213, (235, 235, 235)), (0.62, (150, 90, 20))):
        along = 4 * twelve * radius / 1.829
        cv2.ellipse(
            image, middle, (round(along), round(along * squash)), lean_deg, 0, 360, colour, -1
        )
    return cv2.resize(image, (W, H), interpolation=cv2.INTER_AREA)
