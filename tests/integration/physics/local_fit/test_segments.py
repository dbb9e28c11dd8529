from __future__ import annotations

import numpy as np

from curlshot.physics.local_fit.segments import cut
from curlshot.tests.helpers.physics.segments import trace


def test_a_glide_stays_one_however_long_its_stone_rests_in_the_end() -> None:
    t = np.arange(0, 300, 1 / 25)
    tau = np.minimum(t, 6.0)
    one = trace(t, 0.6 * tau - 0.05 * tau**2, 0.002)
    for hits in ([], [(0, 0.0)]):
        piece = cut(one, hits, 0.1455)[-1]
        assert len(piece.samples) == len(t)
        assert piece.stops
        assert not piece.rest
