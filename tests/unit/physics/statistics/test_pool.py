from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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


def test_one_shot_says_what_it_said_and_that_another_may_differ() -> None:
    pooled = pool([0.83], [0.01], RESTITUTION_SCATTER)
    assert pooled.value == pytest.approx(0.83)
    assert pooled.stderr is not None and 0.01 < pooled.stderr < 0.07
    assert pooled.scatter is None


def test_no_shot_gives_nothing() -> None:
    assert pool([], [], RESTITUTION_SCATTER).value is None


@given(
    st.lists(st.tuples(st.floats(0, 1), st.floats(1e-4, 0.2)), min_size=1, max_size=8),
    st.floats(-3, 3),
)
def test_moves_with_the_values(shots: list[tuple[float, float]], by: float) -> None:
    y, s = np.array(shots).T
    one, other = pool(y, s, RESTITUTION_SCATTER), pool(y + by, s, RESTITUTION_SCATTER)
    assert other.value == pytest.approx((one.value or 0) + by, abs=1e-8)
    assert other.stderr == pytest.approx(one.stderr, rel=1e-6)
    assert y.min() - 1e-12 <= (one.value or 0) <= y.max() + 1e-12


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
