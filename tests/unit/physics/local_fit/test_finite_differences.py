from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.data.results import Estimate, Hit
from curlshot.physics.local_fit.finite_differences import by_finite_differences
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.traces import traces
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


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
