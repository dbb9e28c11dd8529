from __future__ import annotations

import numpy as np

from curlshot.report import figures
from curlshot.report.numbers import plus_minus
from curlshot.tests.helpers.report.drawn import check_layout, texts


def test_hit_gives_normal_and_tangential_parts(shot):
    for rank, hit in enumerate(shot.results.collisions, 1):
        figure = figures.hit_figure(hit, rank)
        check_layout(figure)
        state = hit.after[hit.stones[1]]
        along = state.vx * hit.normal[0] + state.vy * hit.normal[1]
        across = -state.vx * hit.normal[1] + state.vy * hit.normal[0]
        n, t = (np.hypot(0.012 * a, 0.015 * b) for a, b in (hit.normal, hit.normal[::-1]))
        said = [t.get_text() for t in texts(figure)]
        assert plus_minus(along, n) in said
        assert plus_minus(across, t) in said
