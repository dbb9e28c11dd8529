from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import linear_sum_assignment

from curlshot.vision.association.assign import assign


@settings(deadline=None)
@given(st.data(), st.integers(1, 9), st.integers(1, 9))
def test_the_sum_is_the_least_there_is(data: st.DataObject, rows: int, columns: int) -> None:
    values = st.floats(0, 2) | st.just(1e6)
    cost = data.draw(arrays(float, (rows, columns), elements=values))
    pairs = assign(cost)
    assert len({row for row, _ in pairs}) == len({column for _, column in pairs}) == len(pairs)
    assert len(pairs) == min(rows, columns)
    least = cost[linear_sum_assignment(cost)].sum()
    assert sum(cost[pair] for pair in pairs) == pytest.approx(least, rel=1e-12, abs=1e-9)
