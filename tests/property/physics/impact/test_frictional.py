from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from curlshot.physics.impact import Frictional, tangent
from curlshot.tests.helpers.physics.impact_case import (
    Array,
    Case,
    R,
    Spin,
    after_hit,
    closing,
    hits,
    unit,
    velocities,
)


@settings(deadline=None)
@given(hits, unit, st.floats(0, 1), st.floats(0.2, 0.6), velocities)
def test_angular_momentum(case: Case, e: float, mu: float, k: float, place: np.ndarray) -> None:
    assume(closing(case) > 0)
    v1, v2, w1, w2, n, m1, m2 = case
    r1, r2 = place, place + 2 * R * n

    def angular(v1: Array, v2: Array, w1: Spin, w2: Spin) -> float:
        orbit = m1 * (r1[0] * v1[1] - r1[1] * v1[0]) + m2 * (r2[0] * v2[1] - r2[1] * v2[0])
        return float(orbit + k * R**2 * (m1 * w1 + m2 * w2))

    after = after_hit(Frictional(e, mu, k), case)
    scale = (m1 + m2) * 10 * 10
    assert angular(*after) == pytest.approx(angular(v1, v2, w1, w2), abs=1e-12 * scale)


@settings(deadline=None)
@given(hits, unit, st.floats(0.01, 1))
def test_friction_sticks_or_slips(case: Case, e: float, mu: float) -> None:
    assume(closing(case) > 1e-3)
    v1, v2, w1, w2, n, m1, _ = case
    t = tangent(n)
    after = after_hit(Frictional(e, mu, 0.5), case)

    def slip(v1: Array, v2: Array, w1: Spin, w2: Spin) -> float:
        return float((v1 - v2) @ t + R * (w1 + w2))

    along, aside = -m1 * (after.v1 - v1) @ n, m1 * (after.v1 - v1) @ t
    before, left = slip(v1, v2, w1, w2), slip(*after)
    assert abs(aside) <= mu * along * (1 + 1e-9) + 1e-12
    assert before * left >= -1e-9  # friction never turns the slip round
    if abs(left) > 1e-9:
        assert abs(aside) == pytest.approx(mu * along, rel=1e-6, abs=1e-12)
