from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.results import Estimate, Hit
from curlshot.physics.estimate import estimate
from curlshot.physics.local_fit.finite_differences import by_finite_differences
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.traces import traces
from curlshot.tests.unit.physics.watch import RADIUS, hit_motion, watch

E = 0.5


def test_stones_that_part_or_lie_still_tell_nothing() -> None:
    motion = hit_motion(1.5, 0.0, before=1.0, after=1.0)
    known = traces(watch(motion, np.random.default_rng(5), sd=0.001))
    (contact,) = detect_hits(watch(motion, np.random.default_rng(5), sd=0.001), RADIUS)
    late = Hit(
        contact.t + 0.6, 0.0, contact.stones, contact.normal, None, None, {}, {}
    )  # fmt: skip
    assert by_finite_differences(known, [late], {}).hits == (Estimate(),)
    still = {"B": replace(known["B"], xy=np.zeros_like(known["B"].xy))}
    early = replace(late, t=contact.t)
    found = by_finite_differences({**known, **still}, [early], {"B": 2.0})
    assert found.friction == Estimate()
    for rest in (early.t, early.t + 0.04):  # at once, or after a single detection
        assert by_finite_differences(known, [early], {"B": rest}).friction == Estimate()


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
