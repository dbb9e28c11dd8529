from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curlshot.physics.statistics.pool import RESTITUTION_SCATTER, pool


@given(
    st.lists(st.tuples(st.floats(0, 1), st.floats(1e-4, 0.2)), min_size=1, max_size=8),
    st.floats(-3, 3),
)
def test_moves_with_the_values(shots: list[tuple[float, float]], by: float) -> None:
    y, s = np.array(shots).T
    one, other = pool(y, s, RESTITUTION_SCATTER), pool(y + by, s, RESTITUTION_SCATTER)
    assert other.value == pytest.approx((one.value or 0) + by, abs=1e-8)
    assert other.stderr == pytest.approx(one.stderr, rel=1e-6)
    assert y.min() - 1e-12 <= (one.value or 0) <= y.max() + 1e-12
