from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.results import Estimate
from curlshot.physics.estimate import _disagreement
from curlshot.physics.local_fit.hits import pooled


def test_a_pool_takes_chance_for_chance() -> None:
    cov = np.diag([0.01**2, 0.01**2])
    near = pooled(np.array([0.80, 0.815]), cov)
    assert (near.value, near.stderr) == pytest.approx((0.8075, 0.01 / np.sqrt(2)))
    far = pooled(np.array([0.78, 0.84]), cov)
    assert far.stderr == pytest.approx(0.03)
    assert pooled(np.empty(0), np.empty((0, 0))) == Estimate()


@pytest.mark.parametrize(
    ("whole", "agrees"),
    [(Estimate(0.84, 0.003), True), (Estimate(0.86, 0.003), False), (Estimate(), True)],
)
def test_two_ways_that_disagree_are_told(whole: Estimate, agrees: bool) -> None:
    said = _disagreement(Estimate(0.82, 0.01), whole)
    assert (said is None) == agrees
    assert agrees or "disagree" in str(said)
