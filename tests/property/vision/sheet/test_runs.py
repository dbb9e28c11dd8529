from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.vision.sheet.runs import Curves, Runs, smooth


@settings(deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 10_000),
    long=st.integers(3, 40),
    short=st.integers(1, 40),
)
def test_a_line_is_judged_by_itself(seed: int, long: int, short: int) -> None:
    rng = np.random.default_rng(seed)
    parts = [slice(0, long), slice(long, long + short)]
    along, offset = rng.uniform(-4, 9, long + short), rng.normal(0, 1, long + short)
    good = rng.random(long + short) < 0.8
    runs = Runs.of(parts)
    curves, shown = Curves.along(along[runs.index]), good[runs.index] & runs.real
    both, spread = smooth(curves, offset[runs.index], shown, 0.1)
    for k, part in enumerate(parts):
        own = Curves.along(along[None, part])
        alone, sd = smooth(own, offset[None, part], good[None, part], 0.1)
        np.testing.assert_array_equal(both[k, runs.real[k]], alone[0])
        np.testing.assert_allclose(spread[k], sd[0])
    assert not both[~runs.real].any()
    assert (spread >= 0.1).all()
