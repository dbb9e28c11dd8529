from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.estimate import estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.posterior import sample_posterior, summarise
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_draws_have_the_errors_of_the_estimates_and_their_correlation() -> None:
    seen = watch(hit_motion(1.5, 0.15), np.random.default_rng(1), sd=0.003)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    drawn = sample_posterior(found, 4000, np.random.default_rng(2))
    assert drawn is not None
    assert list(drawn.columns) == ["sample", "restitution", "friction", "stone_friction"]
    for name, told in (("restitution", found.restitution), ("friction", found.friction)):
        assert drawn[name].mean() == pytest.approx(told.value, abs=0.1 * (told.stderr or 0))
        assert drawn[name].std() == pytest.approx(told.stderr, rel=0.1)
    summary = summarise(drawn)
    assert summary.samples == 4000
    assert summary.quantiles["restitution"]["0.5"] == pytest.approx(
        found.restitution.value, abs=1e-3
    )
    names = ["restitution", "friction"]
    a, b = (found.shot_fit.names.index(name) for name in names)
    cov = found.shot_fit.cov
    expected = cov[a, b] / np.sqrt(cov[a, a] * cov[b, b])
    assert summary.correlation["restitution"]["friction"] == pytest.approx(expected, abs=0.06)
    assert summary.correlation["friction"]["friction"] == pytest.approx(1.0)
