from __future__ import annotations

import pytest
from hypothesis import assume, given, settings

from curlshot.physics.impact import Frictional, PointMass, RigidBody, resolve
from curlshot.tests.helpers.physics.impact_case import Case, after_hit, closing, hits, unit


@settings(deadline=None)
@given(hits, unit)
def test_special_cases_agree(case: Case, e: float) -> None:
    assume(closing(case) > 0)
    plain = after_hit(PointMass(e), case)
    smooth = after_hit(Frictional(e, 0.0), case)
    kept = after_hit(RigidBody(e), case, spin_after=(case[2], case[3]))
    for other in (smooth, kept):
        for a, b in zip(plain, other, strict=True):
            assert b == pytest.approx(a, abs=1e-12)


@pytest.mark.parametrize("e", [0.0, 0.5, 0.83, 1.0])
def test_a_full_hit_shares_the_speed_out(e: float) -> None:
    after = resolve(PointMass(e), (0, 2.0), (0, 0), 0.7, 0, (0, 1))
    assert after.v1 == pytest.approx([0, 1 - e])
    assert after.v2 == pytest.approx([0, 1 + e])
    assert (after.w1, after.w2) == (0.7, 0)
