"""A small clip and a camera above it."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from curlshot.vision.optics.camera import Camera

SIZE = (321, 241)  # odd both ways
GREY = 120


def camera(frame: int, **kwargs) -> Camera:
    homography = np.array([[60.0, 0, 160], [0, -60.0, 120], [0, 0, 1]])
    return Camera(frame, 0.0, homography, SIZE, **kwargs)


def pictures(folder: Path, count: int = 6) -> list[Path]:
    paths = []
    for k in range(count):
        path = folder / f"{k:03}.png"
        cv2.imwrite(str(path), np.full((SIZE[1], SIZE[0], 3), GREY, np.uint8))
        paths.append(path)
    return paths
