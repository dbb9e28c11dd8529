from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import FCV1, Constant, Fit

SPEEDS = np.array([0.05, 0.3, 1.0, 3.0])


def test_no_fading_part_is_constant_friction() -> None:
    assert Fit(0.0, 0.064, 0.011).deceleration(SPEEDS) == pytest.approx(
        Constant(0.011).deceleration(SPEEDS)
    )


def test_the_form_of_fcv1() -> None:
    law = FCV1()
    same = Fit(law.a, law.v_c, law.b).deceleration(SPEEDS)
    assert same / GRAVITY == pytest.approx(law.deceleration(SPEEDS) / law.gravity)
