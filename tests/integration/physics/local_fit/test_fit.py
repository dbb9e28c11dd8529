from __future__ import annotations

import numpy as np

from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.hit_detection import cut_all
from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import traces
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_covariance_follows_from_the_scatter() -> None:
    motion = hit_motion()
    rng = np.random.default_rng(63)
    places, sd = [], []
    for _ in range(40):
        known = traces(watch(motion, rng, sd=0.005))
        meetings = [Meeting(1.0, ("A", "B"), 1 / 30)]
        pieces, _ = cut_all(known, meetings, RADIUS)
        fit = fit_shot(known, pieces, meetings, RADIUS)
        value, cov = fit.propagate([0], lambda states: states[0].before[0])
        places.append(value)
        sd.append(np.sqrt(np.diag(cov)))
    assert np.allclose(np.std(places, axis=0), np.median(sd, axis=0), rtol=0.4)
