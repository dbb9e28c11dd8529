from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.results import Estimate
from curlshot.physics.statistics.random_effects import RandomEffects, random_effects


def test_values_that_chance_explains_have_their_weighted_mean() -> None:
    found = random_effects(np.array([0.80, 0.81]), np.diag([0.01**2, 0.02**2]))
    assert found.mean == Estimate(pytest.approx(0.802), pytest.approx(0.01 * np.sqrt(0.8)))
    assert found.spread == 0.0
    assert found.excess < 0
    assert random_effects(np.array([0.8]), np.array([[0.0004]])).mean.stderr == pytest.approx(0.02)
    assert random_effects(np.empty(0), np.empty((0, 0))) == RandomEffects()


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


def test_errors_that_are_alike_are_no_spread() -> None:
    cov = 0.01**2 * (np.eye(4) + 50.0)
    together = random_effects(0.2 + np.array([-0.01, 0.0, 0.0, 0.01]), cov)
    assert together.spread == 0.0
    assert together.mean.stderr == pytest.approx(0.01 * np.sqrt(0.25 + 50))
    apart = random_effects(0.2 + np.array([-0.05, 0.0, 0.0, 0.05]), cov)
    assert apart.spread == pytest.approx(0.05 * np.sqrt(2 / 3), rel=0.1)
