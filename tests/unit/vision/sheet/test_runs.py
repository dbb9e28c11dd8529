from __future__ import annotations

import numpy as np

from curlshot.vision.sheet.runs import Curves, Runs, smooth


def test_runs_of_uneven_length_become_a_table() -> None:
    runs = Runs.of([slice(2, 5), slice(7, 8)])
    np.testing.assert_array_equal(runs.index, [[2, 3, 4], [7, 7, 7]])
    np.testing.assert_array_equal(runs.real, [[True, True, True], [True, False, False]])
    assert Runs.of([]).index.size == 0


def test_what_lies_off_the_curve_is_left_out() -> None:
    rng = np.random.default_rng(0)
    along = np.linspace(-4, 9, 40)
    offset = 0.5 + 0.1 * along - 0.02 * along**2 + rng.normal(0, 0.1, 40)
    offset[[3, 20, 33]] += [4.0, -3.0, 5.0]
    keep, sd = smooth(Curves.along(along[None]), offset[None], np.ones((1, 40), bool), 0.05)
    assert not keep[0, [3, 20, 33]].any()
    assert keep.sum() > 30
    assert 0.07 < sd[0] < 0.16


def test_few_points_bend_no_line() -> None:
    # Through three points a parabola would go; the straight line through them leaves a residual.
    along, offset = np.array([[0.0, 1.0, 2.0, 3.0]]), np.array([[0.0, 1.0, 1.0, 0.0]])
    _, sd = smooth(Curves.along(along), offset, np.ones((1, 4), bool), 0.01)
    assert sd[0] > 0.5


def test_nothing_seen_stays_nothing() -> None:
    keep, sd = smooth(Curves.along(np.zeros((1, 5))), np.zeros((1, 5)), np.zeros((1, 5), bool), 0.2)
    assert not keep.any()
    assert sd[0] == 0.2
