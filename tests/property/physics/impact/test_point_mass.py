from __future__ import annotations

import pytest
from hypothesis import assume, given, settings

from curlshot.physics.impact import Frictional, PointMass, RigidBody
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
