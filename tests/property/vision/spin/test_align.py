from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.tests.helpers.vision.align import spectra
from curlshot.vision.spin.align import turned


@settings(max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3))
def test_a_turned_picture_is_that_of_the_turned_cap(start: float, turn: float) -> None:
    before, after = spectra([start, start + turn], [(0.0, 0.0)] * 2)
    difference = turned(before[None], np.array([turn]))[0] - after
    assert np.abs(difference).max() < 0.05 * np.abs(after).max()
