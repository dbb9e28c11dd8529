from __future__ import annotations

import pytest
from hypothesis import assume, given, settings

from curlshot.physics.impact import RigidBody, tangent
from curlshot.tests.helpers.physics.impact_case import (
    Case,
    R,
    after_hit,
    closing,
    hits,
    spins,
    unit,
)


@settings(deadline=None)
@given(hits, unit, spins, spins)
def test_rigid_body_keeps_each_contact_speed(case: Case, e: float, a1: float, a2: float) -> None:
    assume(closing(case) > 0)
    v1, v2, w1, w2, n, m1, m2 = case
    t = tangent(n)
    after = after_hit(RigidBody(e), case, spin_after=(a1, a2))
    assert (float(after.w1), float(after.w2)) == (a1, a2)
    assert after.v1 @ t + R * a1 == pytest.approx(v1 @ t + R * w1, abs=1e-12)
    assert after.v2 @ t - R * a2 == pytest.approx(v2 @ t - R * w2, abs=1e-12)
    normal = m1 * (after.v1 - v1) @ n + m2 * (after.v2 - v2) @ n
    assert normal == pytest.approx(0.0, abs=1e-9)
    assert (after.v2 - after.v1) @ n == pytest.approx(e * closing(case), abs=1e-12)
