from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curlshot.data.geometry import origin_to_segment

coordinates = st.floats(-10, 10, allow_subnormal=False)


@given(x0=coordinates, y0=coordinates, x1=coordinates, y1=coordinates)
def test_no_point_of_the_segment_is_nearer(x0: float, y0: float, x1: float, y1: float) -> None:
    share = np.linspace(0, 1, 2001)
    sampled = np.hypot(x0 + share * (x1 - x0), y0 + share * (y1 - y0)).min()
    spacing = np.hypot(x1 - x0, y1 - y0) / 2000
    found = origin_to_segment(x0, y0, x1, y1)
    assert sampled - spacing - 1e-9 <= found <= sampled + 1e-9


def test_a_point_is_a_segment_without_length() -> None:
    assert origin_to_segment(3.0, 4.0, 3.0, 4.0) == pytest.approx(5.0)
