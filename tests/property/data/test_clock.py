from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curlshot.data.clock import uniform_steps


@given(
    fps=st.floats(5, 400),
    start=st.floats(0, 100),
    gone=st.sets(st.integers(1, 58), max_size=40),
)
def test_uniform_steps_are_found_with_frames_missing(
    fps: float, start: float, gone: set[int]
) -> None:
    count = np.array([k for k in range(60) if k not in gone])
    if (np.diff(count) == 1).sum() == 0:
        return
    steps, first, step = uniform_steps(start + count / fps)
    np.testing.assert_array_equal(steps, count)
    assert first == pytest.approx(start, abs=1e-9)
    assert step == pytest.approx(1 / fps, rel=1e-9)
