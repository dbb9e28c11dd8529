from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.tests.helpers.vision.circles import fitted
from curlshot.tests.helpers.vision.rims import RADIUS, RAYS
from curlshot.vision.detection.rays import directions


@settings(deadline=None, max_examples=30)
@given(x=st.floats(-0.01, 0.01), y=st.floats(-0.01, 0.01), growth=st.floats(-0.004, 0.004))
def test_a_circle_aside_is_found_where_it_is(x: float, y: float, growth: float) -> None:
    around = directions(RAYS)[1]
    along = around @ [x, y]
    edge = along + np.sqrt(along**2 - x * x - y * y + (RADIUS + growth) ** 2)
    fits = fitted(edge, np.ones(RAYS, bool))
    assert fits.ok[0]
    np.testing.assert_allclose(fits.shift[0], (x, y), atol=0.0008)
    np.testing.assert_allclose(fits.radii[0, 0], RADIUS + growth, atol=0.0015)
    assert fits.shares[0, 0] > 0.9
