from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.physics.local_fit.breaks import breaks
from curlshot.tests.helpers.physics.breaks import T, seen


@settings(max_examples=20, deadline=None)
@given(when=st.floats(0.5, 3.5), before=st.floats(-1.5, 1.5), after=st.floats(-1.5, 1.5))
def test_a_kink_is_found_within_two_frames(when: float, before: float, after: float) -> None:
    if abs(before - after) < 0.4:
        return
    y = np.where(when > T, before * (T - when), after * (T - when))
    assert breaks(T, seen(y, 0.003), np.full((len(T), 2), 0.003)) == pytest.approx(
        [when], abs=2.5 / 30
    )
