from __future__ import annotations

import pytest

from curlshot.physics.impact import PointMass, resolve


@pytest.mark.parametrize("e", [0.0, 0.5, 0.83, 1.0])
def test_a_full_hit_shares_the_speed_out(e: float) -> None:
    after = resolve(PointMass(e), (0, 2.0), (0, 0), 0.7, 0, (0, 1))
    assert after.v1 == pytest.approx([0, 1 - e])
    assert after.v2 == pytest.approx([0, 1 + e])
    assert (after.w1, after.w2) == (0.7, 0)
