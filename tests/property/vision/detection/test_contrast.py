from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from curlshot.vision.detection.contrast import (
    by_hue,
)

GRANITE = np.array([[118.0, 127.0, 126.0]])


@given(st.floats(0, 120), st.floats(-100, 100))
def test_a_little_more_hue_changes_little(hue: float, light: float) -> None:
    caps = GRANITE + np.array([[light, hue, 0.0], [light, hue + 0.1, 0.0]])
    first, second = (by_hue(caps, GRANITE) * (caps - GRANITE))[:, 0]
    assert abs(first - second) < 0.08  # 2 h (1 − h²) is at most 0.77
