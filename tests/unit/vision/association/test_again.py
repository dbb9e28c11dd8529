from __future__ import annotations

import numpy as np

from curlshot.vision.association.again import drifts


def test_drifts_are_told_by_the_next_picture_or_by_the_one_before() -> None:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 2.0]])
    before = np.array([[1.0, 0.08], [0.0, 0.3]])
    after = np.array([[0.1, 0.0], [1.01, 0.0]])
    found = drifts(places, before, after, 0.2)
    np.testing.assert_allclose(found, [[0.1, 0.0], [0.01, 0.0], [0.0, 0.0]], atol=1e-12)
    found = drifts(places, before, np.empty((0, 2)), 0.2)
    np.testing.assert_allclose(found, [[0.0, 0.0], [0.0, -0.08], [0.0, 0.0]], atol=1e-12)
