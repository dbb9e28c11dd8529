from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.physics.filter import rate_filter, reference_filter
from curlshot.tests.helpers.physics.rate_filter import random_stretch


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 1 << 30), n=st.integers(1, 60))
def test_closed_form_is_the_textbook_filter(seed: int, n: int) -> None:
    stretch = random_stretch(np.random.default_rng(seed), n)
    mean, spread, seen = rate_filter.filtered(stretch)
    its_mean, its_spread, its_seen = reference_filter.filtered(stretch)
    np.testing.assert_array_equal(seen, its_seen)
    np.testing.assert_allclose(mean, its_mean, rtol=1e-7, atol=1e-7)
    # Where nothing was known but 100 rad, rounding is what differs.
    np.testing.assert_allclose(spread, its_spread, rtol=2e-3)
