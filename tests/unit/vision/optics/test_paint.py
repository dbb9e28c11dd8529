from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.cameras import ice_points
from curlshot.vision.optics.paint import EIGHT, FIXED, TEE_LINE, TWELVE, Marks, fixed, joined
from curlshot.vision.optics.rig import OVERHEAD, start_rig


def test_marks_lie_on_their_lines() -> None:
    rig = start_rig(OVERHEAD)
    line = np.array([TWELVE, EIGHT, TEE_LINE])
    place = ice_points(line, np.array([np.pi / 2, 0.0, 0.7]), rig)
    np.testing.assert_allclose(place, [[0, 1.829], [rig[6], 0], [0.7, 0]], atol=1e-12)


def test_joined_marks_keep_what_each_lies_on() -> None:
    ice = np.array([[0.3, -0.2], [1.0, 2.0]])
    points = fixed(ice, np.array([[100.0, 50.0], [300.0, 80.0]]), 0.4)
    edge = Marks(np.array([TWELVE]), np.zeros(1), np.zeros((1, 2)), np.eye(2)[:1], np.ones(1))
    both = joined([edge, points])
    assert both.line.tolist() == [TWELVE, *[FIXED] * 4]
    place = ice_points(both.line, both.along, start_rig(OVERHEAD), both.across)
    np.testing.assert_allclose(place, [[1.829, 0], *ice, *ice], atol=1e-12)
    assert len(joined([])) == 0
