"""Cameras over ice for the tests of ``curlshot check``."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.vision.detection.detection import Detection
from curlshot.vision.optics.camera import Camera

SIZE = (320, 240)


def camera(frame: int, **kwargs) -> Camera:
    homography = np.array([[50.0, 0, 160], [0, -50.0, 120], [0, 0, 1]])
    return Camera(frame, frame / 25, homography, SIZE, **kwargs)


def stone(x: float, y: float) -> Detection:
    return Detection(
        x, y, 1e-3, 1e-3, 0.0, np.zeros(3), 1.0, 2.5, (1.0, 1.0), 0.0, (), (160.0, 120.0), 0.02
    )


def table(count: int, worst: int) -> pd.DataFrame:
    rms = np.full(count, 0.2)
    rms[worst] = 0.9
    return pd.DataFrame(
        {"frame": np.arange(count) + 5, "t": np.arange(count) / 25, "rms_px": rms,
         "found": (np.arange(count) % 7 != 3).astype(int), "sd": 0.002}
    )  # fmt: skip
