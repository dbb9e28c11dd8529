from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.tests.helpers.vision.half_turns import CLOSE, error, pictures
from curlshot.vision.spin.half_turns import unfolded


@settings(max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.integers(8, 30), st.integers(0, 12), st.sampled_from([-2, -1, 1, 2]))
def test_half_turns_beside_a_gap_are_taken_out(
    spin: float, at: int, hidden: int, halves: int
) -> None:
    times = np.arange(50) / 25
    true = spin * times
    angles = true + np.pi * halves * (np.arange(50) >= at)
    angles[at : at + hidden] = np.nan
    out = unfolded(times, pictures(true), angles)
    assert np.array_equal(np.isfinite(out), np.isfinite(angles))
    assert error(out, true) < CLOSE
