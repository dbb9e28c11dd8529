from __future__ import annotations

import numpy as np

from curlshot.physics.curl import NoCurl


def test_nothing_turns_and_no_spin_is_lost() -> None:
    speeds = np.array([0.0, 0.5, 3.0])
    assert not NoCurl().turn_rate(speeds).any()
    assert not NoCurl().spin_loss(speeds).any()
