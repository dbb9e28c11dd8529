from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from curlshot.physics.impact import Frictional, PointMass
from curlshot.tests.helpers.physics.impact_case import Case, after_hit, closing, energy, hits, unit


@settings(deadline=None)
@given(hits, unit, st.floats(0, 1))
def test_momentum_restitution_and_energy(case: Case, e: float, mu: float) -> None:
    assume(closing(case) > 1e-6)
    v1, v2, w1, w2, n, m1, m2 = case
    for model in (PointMass(e), Frictional(e, mu, 0.5)):
        after = after_hit(model, case)
        scale = (m1 + m2) * (np.linalg.norm(v1) + np.linalg.norm(v2))
        residual = m1 * (after.v1 - v1) + m2 * (after.v2 - v2)
        assert np.abs(residual).max() <= 1e-12 * scale
        assert (after.v2 - after.v1) @ n == pytest.approx(e * closing(case), abs=1e-12)
        before = energy(v1, v2, w1, w2, m1, m2)
        assert energy(*after, m1, m2) <= before * (1 + 1e-12)


@settings(deadline=None)
@given(hits, unit, st.floats(0, 1), st.floats(-math.pi, math.pi))
def test_rotation_mirror_and_exchange(case: Case, e: float, mu: float, angle: float) -> None:
    assume(closing(case) > 0)
    v1, v2, w1, w2, n, m1, m2 = case
    model = Frictional(e, mu)
    after = after_hit(model, case)
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    turned = after_hit(model, (turn @ v1, turn @ v2, w1, w2, turn @ n, m1, m2))
    assert turned.v1 == pytest.approx(turn @ after.v1, abs=1e-11)
    assert turned.w2 == pytest.approx(after.w2, abs=1e-9)
    flip = np.array([-1.0, 1.0])
    mirrored = after_hit(model, (flip * v1, flip * v2, -w1, -w2, flip * n, m1, m2))
    assert mirrored.v2 == pytest.approx(flip * after.v2, abs=1e-12)
    assert mirrored.w1 == pytest.approx(-after.w1, abs=1e-12)
    exchanged = after_hit(model, (v2, v1, w2, w1, -n, m2, m1))
    assert exchanged.v1 == pytest.approx(after.v2, abs=1e-12)
    assert exchanged.w1 == pytest.approx(after.w2, abs=1e-10)
