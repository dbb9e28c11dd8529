from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from curlshot.vision.optics.predict import predict


@given(
    st.integers(1, 2),
    st.lists(st.floats(-3, 3), min_size=3, max_size=3),
    st.sampled_from([1.0, -1.0]),
)
def test_even_and_evenly_growing_motion_is_foretold(
    degree: int, terms: list[float], way: float
) -> None:
    times = way * np.array([0.0, 0.04, 0.12, 0.16, 0.2, 0.28])
    ahead = way * np.array([0.32, 0.44])
    course = np.array(terms[: degree + 1])
    seen = np.polynomial.polynomial.polyval(times, course)[:, None]
    due = np.polynomial.polynomial.polyval(ahead, course)[:, None]
    np.testing.assert_allclose(predict(times.tolist(), seen, ahead.tolist()), due, atol=1e-6)
