from __future__ import annotations

import numpy as np

from curlshot.physics.local_fit.local import estimate_locally
from curlshot.synthetic.physics import Ice, Start, simulate
from curlshot.tests.helpers.physics.watch import RADIUS, watch


def test_a_short_glide_that_seems_to_gain_speed() -> None:
    motion = simulate([Start(0, 0, 0, 1.0, 0, 0.5)], 1.0, ice=Ice(b=0.0001), step=1e-3)
    for seed in range(20):
        seen = watch(motion, np.random.default_rng(seed), sd=0.002)
        found = estimate_locally(seen, (), radius=RADIUS)
        if found.friction.value is not None and found.friction.value < 0:
            break
    # One glide cannot differ from another.
    assert "not distinguishable from zero" in str(found.friction_doubt)
    assert not [text for text in found.warnings if "friction" in text]
