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


def test_errors_that_are_alike_are_no_spread() -> None:
    cov = 0.01**2 * (np.eye(4) + 50.0)
    together = random_effects(0.2 + np.array([-0.01, 0.0, 0.0, 0.01]), cov)
    assert together.spread == 0.0
    assert together.mean.stderr == pytest.approx(0.01 * np.sqrt(0.25 + 50))
    apart = random_effects(0.2 + np.array([-0.05, 0.0, 0.0, 0.05]), cov)
    assert apart.spread == pytest.approx(0.05 * np.sqrt(2 / 3), rel=0.1)
