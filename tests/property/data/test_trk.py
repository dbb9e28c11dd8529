from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from curlshot.tests.helpers.data.trk import SYSTEM


@given(
    st.lists(
        st.tuples(st.integers(0, 9), st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)),
        min_size=1,
        max_size=5,
    )
)
def test_pixels_are_the_inverse_of_places(rows: list[tuple[int, float, float]]) -> None:
    frames, *marks = np.array(rows).T
    pixels = np.column_stack(marks)
    np.testing.assert_allclose(
        SYSTEM.pixels(frames, SYSTEM.world(frames, pixels)), pixels, atol=1e-9
    )
