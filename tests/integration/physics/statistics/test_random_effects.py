from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.statistics.random_effects import random_effects


@pytest.mark.parametrize("sharp", [1e-4, 0.02])
def test_the_error_of_the_mean_means_it_however_sharp_some_values_are(sharp: float) -> None:
    rng = np.random.default_rng(1)
    scores, spreads = [], []
    for _ in range(400):
        sd = np.where(np.arange(30) < 3, sharp, 0.02)
        values = 1.0 + rng.normal(0, 0.1, 30) + rng.normal(0, sd)
        found = random_effects(values, np.diag(sd**2))
        assert found.mean.value is not None and found.mean.stderr is not None
        scores.append((found.mean.value - 1.0) / found.mean.stderr)
        spreads.append(found.spread)
    assert np.sqrt(np.mean(np.square(scores))) == pytest.approx(1.0, abs=0.12)
    assert np.median(spreads) == pytest.approx(0.1, rel=0.1)
