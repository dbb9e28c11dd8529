from __future__ import annotations

import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import Penner


def test_friction_as_published() -> None:
    friction = Penner().deceleration([0.3, 1.0, 2.0, 3.0]) / GRAVITY
    assert friction == pytest.approx([0.0146, 0.0080, 0.0057, 0.0046], abs=6e-5)
