from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.data.results import Estimate, Friction
from curlshot.physics.estimate import Estimates
from curlshot.physics.posterior import sample_posterior, summarise


def test_what_cannot_be_is_not_drawn_and_what_is_not_told_is_empty() -> None:
    found = Estimates(restitution=Estimate(0.05, 0.1))
    drawn = sample_posterior(found, 500, np.random.default_rng(0))
    assert drawn is not None
    assert len(drawn) == 500
    assert drawn["restitution"].between(0, 1.5).all()
    assert drawn["friction"].isna().all()
    assert set(summarise(drawn).quantiles) == {"restitution"}
    assert sample_posterior(Estimates(), 10, np.random.default_rng(0)) is None
    assert sample_posterior(found, 0, np.random.default_rng(0)) is None
    both = replace(found, friction=Friction(0.01, 0.001))
    one, two = (sample_posterior(both, 50, np.random.default_rng(3)) for _ in range(2))
    assert one is not None
    assert two is not None
    assert one.equals(two)
