"""What tests of glance share."""

from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.detection.detection import Detection


def stone(x: float, colour: np.ndarray, score: float) -> Detection:
    around = np.zeros((20, 3))
    return detection((x, 0.0), colour, score)._replace(
        cap_samples=around + colour, granite_samples=around + np.array([90.0, 128.0, 128.0])
    )
