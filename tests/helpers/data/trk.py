"""What tests of trk share."""

from __future__ import annotations

import numpy as np

from curlshot.data.trk import Coordinates

SYSTEM = Coordinates(
    np.array([0, 3]),
    np.array([[160.0, 120.0], [170.0, 110.0]]),
    np.radians([10.0, -25.0]),
    np.array([[50.0, 50.0], [40.0, 42.0]]),
)
