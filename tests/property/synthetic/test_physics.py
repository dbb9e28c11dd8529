"""The independent physics against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curlshot.synthetic.physics import RADIUS, Impact, collide

speeds = st.floats(-3, 3)
spins = st.floats(-4, 4)


@given(speeds, speeds, spins, spins, st.floats(0, 6.28), st.floats(0, 1), st.floats(0, 1))
def test_impact_keeps_what_must_be_kept(
    vx: float, vy: float, w1: float, w2: float, angle: float, e: float, mu: float
) -> None:
    n = (float(np.cos(angle)), float(np.sin(angle)))
    closing = vx * n[0] + vy * n[1]
    if closing <= 0:
        return
    impact = Impact(e, mu)
    first, second = collide((vx, vy, w1), (0, 0, w2), n, impact)
    assert np.allclose(np.add(first, second)[:2], [vx, vy], atol=1e-12)
    parting = (second[0] - first[0]) * n[0] + (second[1] - first[1]) * n[1]
    assert parting == pytest.approx(e * closing, abs=1e-12)
    inertia = impact.inertia * RADIUS**2

    def about_contact_start(a: tuple[float, ...], b: tuple[float, ...]) -> float:
        lever = 2 * RADIUS * (n[0] * b[1] - n[1] * b[0])  # second stone's place seen from first
        return inertia * (a[2] + b[2]) + lever

    before = about_contact_start((vx, vy, w1), (0.0, 0.0, w2))
    assert about_contact_start(first, second) == pytest.approx(before, abs=1e-10)

    def energy(*stones: tuple[float, float, float]) -> float:
        return sum(s[0] ** 2 + s[1] ** 2 + inertia * s[2] ** 2 for s in stones)

    assert energy(first, second) <= energy((vx, vy, w1), (0.0, 0.0, w2)) + 1e-9
