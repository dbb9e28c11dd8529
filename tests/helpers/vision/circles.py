"""What tests of circles share."""

from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.rims import rim_of
from curlshot.vision.detection.circles import Fits, fit_circles


def fitted(edge: np.ndarray, inside: np.ndarray, lean: np.ndarray | None = None) -> Fits:
    rays, rim = rim_of(edge, inside, lean)
    return fit_circles(rays, (rim,), slack=0.05, reach=0.035, noise=np.array([0.0005]))
