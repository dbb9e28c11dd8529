from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.estimate import estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch

E = 0.5


def test_the_method_of_the_study_beside_ours() -> None:
    motion = hit_motion(1.5, 0.0, before=1.0, after=4.5, restitution=E, stone_friction=0.0)
    seen = watch(motion, np.random.default_rng(4), sd=0.001)
    methods = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).methods
    assert set(methods) == {"local", "shot_fit", "finite-differences"}
    plain, local = methods["finite-differences"], methods["local"]
    # Means over half a second on either side: both stones slow down by 0.027 m/s in a quarter.
    slower = 0.0109 * 9.81 * 0.25
    closing = 1.5 + slower
    expected = E * 1.5 / closing
    assert plain.restitution.value == pytest.approx(expected, abs=0.01)
    assert local.restitution.value == pytest.approx(E, abs=0.005)
    assert plain.restitution.stderr is not None
    # A alone comes to rest; its mean speed over the window is below that just after the hit.
    after = 0.5 * (1 - E) * 1.5
    assert plain.friction.value == pytest.approx(0.0109 * (1 - slower / after), rel=0.05)
    assert methods["shot_fit"].note is None
    assert methods["shot_fit"].restitution.value == pytest.approx(E, abs=0.005)
