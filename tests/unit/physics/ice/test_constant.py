from __future__ import annotations

import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import Constant


def test_friction_is_the_same_at_all_speeds() -> None:
    assert Constant(0.0109).deceleration([0.01, 0.3, 1.0, 3.0]) == pytest.approx(0.0109 * GRAVITY)
