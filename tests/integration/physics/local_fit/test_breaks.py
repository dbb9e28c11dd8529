from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.breaks import breaks


def test_a_stone_at_rest_has_no_breaks_and_a_small_nudge_is_one() -> None:
    rng = np.random.default_rng(8)
    t, sd = np.arange(300) / 30, np.full((300, 2), 1e-3)
    for _ in range(20):
        xy = rng.normal(0, 1e-3, (300, 2))
        assert breaks(t, xy, sd) == []
        xy[150:, 1] += 0.006
        assert breaks(t, xy, sd) == pytest.approx([t[150]], abs=0.2)
