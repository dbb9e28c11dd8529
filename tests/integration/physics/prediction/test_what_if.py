from __future__ import annotations

import math

import numpy as np

from curlshot.data.results import Input, Results
from curlshot.physics.estimate import estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.replay import simulate_measured
from curlshot.physics.prediction.start import measured_start
from curlshot.physics.prediction.what_if import odds, sample
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_a_shot_thrown_again_ends_as_far_from_where_it_did_as_is_stated() -> None:
    """From tracks of places alone, good to 3 mm, of one hit; the true end is the renderer's."""
    pulls, off = [], []
    for seed in range(6):
        motion = hit_motion(1.6, 0.06, before=1.2, after=1.5)
        table = watch(motion, np.random.default_rng(seed), sd=0.003)
        hits = detect_hits(table, RADIUS)
        found = estimate(table, hits, radius=RADIUS)
        tracks = smooth(table, hits, radius=RADIUS)
        again = simulate_measured(tracks, found, radius=RADIUS)
        results = Results(
            Input(("a.csv",), 30.0, 80, 2.7), found.restitution, found.friction,
            found.collisions, radius=RADIUS, simulations=again.scores, origin_at_tee=False,
        )  # fmt: skip
        assert again.ensemble is not None
        start = measured_start(tracks, results, again.ensemble)
        told = odds(sample(start, 200, (0.0, 0.0)), start)
        truth = hit_motion(1.6, 0.06, before=1.2, after=40.0)
        ends = dict(zip("AB", truth.at(truth.times[-1:])[0][:, :2], strict=True))
        for name, (x, y) in ends.items():
            item = told[name]
            assert item.x is not None and item.y is not None and item.sd_x and item.sd_y
            pulls += [(item.x - x) / item.sd_x, (item.y - y) / item.sd_y]
            off.append(math.hypot(item.x - x, item.y - y))
    assert np.sqrt(np.mean(np.square(pulls))) < 1.6
    assert np.sqrt(np.mean(np.square(pulls))) > 0.4
    assert np.median(off) < 0.05
