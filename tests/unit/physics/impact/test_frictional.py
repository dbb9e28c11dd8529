from __future__ import annotations

import math

import numpy as np
import pytest

from curlshot.physics.impact import Frictional, resolve


def test_a_hit_as_another_program_has_it() -> None:
    # e = 1, μ_s = 0.2, k = 0.5, R = 0.145 m, 1.992 m/s, 0.10 m off the centre.
    n = np.array([0.10, math.sqrt(0.29**2 - 0.01)]) / 0.29
    after = resolve(Frictional(1.0, 0.2, 0.5), (0, 1.992), (0, 0), 0, 0, n, 0.145)
    assert after.v1 == pytest.approx([-0.539, 0.199], rel=0.01)
    assert after.v2 == pytest.approx([0.539, 1.793], rel=0.01)
    assert (after.w1, after.w2) == pytest.approx((-1.591, -1.591), rel=0.01)
