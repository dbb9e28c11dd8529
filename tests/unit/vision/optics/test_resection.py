from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.tests.helpers.vision.cameras import SD, SIZE, marks, true_rig, views
from curlshot.vision.optics.linear import Observations
from curlshot.vision.optics.paint import CENTRE_LINE, fixed, joined
from curlshot.vision.optics.pose import View, project
from curlshot.vision.optics.resection import solve_view, solve_views
from curlshot.vision.optics.rig import OVERHEAD, POSITION, start_rig


def test_exact_marks_give_the_camera_back() -> None:
    rng = np.random.default_rng(2)
    rig = true_rig()
    truth = views(6)
    frames = [marks(rng, v.vector, rig, 0.0) for v in truth]
    start = [View(v.vector + rng.normal(0, 0.004, 4)) for v in truth]
    for seen, begin, true in zip(frames, start, truth, strict=True):
        found = solve_view(seen, begin, rig, SIZE).view
        np.testing.assert_allclose(found.vector, true.vector, atol=2e-4)


def test_wrong_points_do_not_pull() -> None:
    rng = np.random.default_rng(4)
    rig, truth = true_rig(), views(4)
    frames = []
    for v in truth:
        m = marks(rng, v.vector, rig, 0.1)
        wrong = rng.random(len(m)) < 0.15
        off = m.normal * (rng.uniform(3, 8, (len(m), 1)) * wrong[:, None])
        frames.append(replace(m, pixel=m.pixel + off))
    for seen, true in zip(frames, truth, strict=True):
        found = solve_view(seen, true, rig, SIZE).view
        tee = project(np.zeros((1, 2)), found.vector, rig, SIZE)
        np.testing.assert_allclose(tee, project(np.zeros((1, 2)), true.vector, rig, SIZE), atol=0.3)


def test_without_lines_the_roll_stays_where_it_was() -> None:
    rng = np.random.default_rng(6)
    rig = start_rig(OVERHEAD, (0.0, 0.0, 9.0))
    view = View(np.array([0.0, 0.0, 0.05, 7.3]))
    m = marks(rng, view.vector, rig, 0.1)
    circles = m.pick(m.line < CENTRE_LINE)
    found = solve_view(circles, view, rig, SIZE).view
    assert abs(found.vector[2] - 0.05) < 0.01
    assert np.isfinite(found.vector).all()
    assert rig[POSITION][2] == 9.0


def test_points_of_known_place_fix_a_view() -> None:
    rig, view = true_rig(), views(1)[0]
    ice = np.array([[0.3, -1.0], [1.5, 0.2], [-1.2, 2.4]])
    seen = fixed(ice, project(ice, view.vector, rig, SIZE), 0.5)
    found = solve_view(seen, View(view.vector + np.array([0.02, -0.01, 0.03, 0.04])), rig, SIZE)
    np.testing.assert_allclose(found.view.vector, view.vector, atol=1e-3)
    assert found.rms < 0.05
    assert found.inliers.all()


def test_views_of_no_marks_are_not_known() -> None:
    rig, view = true_rig(), views(1)[0]
    found = solve_view(joined([]), view, rig, SIZE)
    np.testing.assert_array_equal(found.view.vector, view.vector)
    assert np.sqrt(found.cov[0, 0]) > 1.0
    assert np.isnan(found.rms)


def test_views_fitted_together_are_those_fitted_alone() -> None:
    rng = np.random.default_rng(8)
    rig, truth = true_rig(), views(5)
    frames = [marks(rng, v.vector, rig, SD) for v in truth]
    frames[2] = frames[2].pick(np.zeros(len(frames[2]), bool))
    start = [View(v.vector + rng.normal(0, 0.003, 4)) for v in truth]
    together = Observations(joined(frames), SIZE, counts=[len(m) for m in frames])
    for k, found in enumerate(solve_views(together, start, rig)):
        alone = solve_view(frames[k], start[k], rig, SIZE)
        np.testing.assert_allclose(found.view.vector, alone.view.vector, atol=2e-5)
        np.testing.assert_allclose(np.diag(found.cov), np.diag(alone.cov), rtol=0.05)
        np.testing.assert_array_equal(found.inliers.shape, alone.inliers.shape)
