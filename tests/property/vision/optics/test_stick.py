from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curlshot.vision.optics.stick import stick_camera


@given(
    st.floats(0, 640), st.floats(0, 480), st.floats(-math.pi, math.pi), st.floats(5, 500),
    st.floats(0.01, 5),
)  # fmt: skip
def test_the_stick_has_its_length_and_starts_at_the_origin(
    x: float, y: float, angle: float, pixels: float, metres: float
) -> None:
    end = (x + pixels * math.cos(angle), y + pixels * math.sin(angle))
    camera = stick_camera((x, y, *end, metres), (640, 480))
    assert camera.ice(np.array([x, y])) == pytest.approx([0, 0], abs=1e-9)
    assert np.hypot(*camera.ice(np.array(end))) == pytest.approx(metres)
