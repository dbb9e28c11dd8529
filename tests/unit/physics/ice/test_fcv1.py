from __future__ import annotations

import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import FCV1


def test_friction_as_published() -> None:
    friction = FCV1().deceleration([0.3, 1.0, 2.0, 3.0]) / GRAVITY
    assert friction == pytest.approx([0.01179, 0.00815, 0.00724, 0.00692], abs=6e-5)
