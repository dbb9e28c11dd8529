from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.tests.helpers.vision.handles import spectrum
from curlshot.vision.spin.facing import angle_between


@settings(max_examples=40, deadline=None)
@given(st.floats(-3, 3), st.floats(-0.2, 0.2))
def test_counter_clockwise_turn_is_found_to_a_fraction_of_a_ray(start: float, turn: float) -> None:
    angle, likeness = angle_between(spectrum(start), spectrum(start + turn), 0.0, 0.3)
    assert angle == pytest.approx(turn, abs=0.004)
    assert likeness > 0.98
