from __future__ import annotations

import pytest

from curlshot.physics.impact import RigidBody, resolve


def test_rigid_body_needs_the_spins_after() -> None:
    with pytest.raises(ValueError, match="spins after"):
        resolve(RigidBody(), (1, 0), (0, 0), 0, 0, (1, 0))
