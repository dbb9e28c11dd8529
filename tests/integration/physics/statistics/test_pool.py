from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.statistics.pool import RESTITUTION_SCATTER, pool


@pytest.mark.parametrize("shots", [2, 3, 5, 12])
@pytest.mark.parametrize("scatter", [0.0, 0.02, 0.05])
def test_errors_of_few_shots_cover(shots: int, scatter: float) -> None:
    rng = np.random.default_rng(shots)
    inside = 0
    for _ in range(800):
        s = rng.uniform(0.005, 0.03, shots)
        y = 0.83 + np.hypot(s, scatter) * rng.standard_normal(shots)
        pooled = pool(y, s, RESTITUTION_SCATTER)
        assert pooled.value is not None and pooled.stderr is not None
        inside += abs(pooled.value - 0.83) < 2 * pooled.stderr
    # Cautious where there is no scatter and few shots; never far too sure.
    assert inside / 800 > 0.91
