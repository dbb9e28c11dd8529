from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.statistics.pool import RESTITUTION_SCATTER, pool


def test_without_scatter_many_shots_give_the_weighted_mean() -> None:
    rng = np.random.default_rng(1)
    s = rng.uniform(0.005, 0.02, 400)
    y = 0.83 + s * rng.standard_normal(400)
    pooled = pool(y, s, RESTITUTION_SCATTER)
    assert pooled.value == pytest.approx(np.average(y, weights=s**-2), abs=2e-4)
    assert pooled.stderr == pytest.approx(np.sum(s**-2.0) ** -0.5, rel=0.1)
    assert pooled.scatter is not None and pooled.scatter < 0.003


def test_exact_values_give_mean_and_scatter_of_a_sample() -> None:
    rng = np.random.default_rng(2)
    y = 0.83 + 0.03 * rng.standard_normal(300)
    pooled = pool(y, np.full(300, 1e-4), RESTITUTION_SCATTER)
    assert pooled.value == pytest.approx(y.mean(), abs=1e-4)
    assert pooled.stderr == pytest.approx(y.std() / 300**0.5, rel=0.05)
    assert pooled.scatter == pytest.approx(y.std(), rel=0.05)


def test_one_shot_says_what_it_said_and_that_another_may_differ() -> None:
    pooled = pool([0.83], [0.01], RESTITUTION_SCATTER)
    assert pooled.value == pytest.approx(0.83)
    assert pooled.stderr is not None and 0.01 < pooled.stderr < 0.07
    assert pooled.scatter is None


def test_no_shot_gives_nothing() -> None:
    assert pool([], [], RESTITUTION_SCATTER).value is None


@pytest.mark.parametrize(
    ("values", "stderrs", "scale"),
    [([1.0], [0.0], 0.1), ([1.0], [0.1, 0.1], 0.1), ([np.nan], [0.1], 0.1), ([1.0], [0.1], 0.0)],
)
def test_refuses_what_is_no_measurement(
    values: list[float], stderrs: list[float], scale: float
) -> None:
    with pytest.raises(ValueError):
        pool(values, stderrs, scale)


def test_shots_that_lie_wide_are_not_argued_together() -> None:
    pooled = pool([0.10, 0.20, 0.15], [0.001] * 3, 0.0025)
    assert pooled.stderr is not None and pooled.stderr > 0.025
    assert pooled.scatter is not None and pooled.scatter > 0.03
