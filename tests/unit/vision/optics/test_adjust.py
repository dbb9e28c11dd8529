from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.data.sheet import HOUSE
from curlshot.tests.helpers.vision.cameras import SD, SIZE, marks, true_rig, views
from curlshot.vision.optics.adjust import Solution, solve
from curlshot.vision.optics.paint import CIRCLES
from curlshot.vision.optics.pose import View, project
from curlshot.vision.optics.resection import ROUND
from curlshot.vision.optics.rig import K1, OVERHEAD, POSITION, R4, R8, start_rig


def test_what_frames_share_is_found_with_their_views() -> None:
    rig, truth = true_rig(), views(8)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        frames = [marks(rng, v.vector, rig, SD) for v in truth]
        found = solve(
            frames, truth, start_rig(OVERHEAD), SIZE, prior=OVERHEAD, sharing=1.0, iterations=30
        )
        assert np.abs(found.rig - rig)[POSITION].max() < 0.08
        assert np.abs(found.rig - rig)[[R8, R4]].max() < 0.0005
        np.testing.assert_allclose(found.rms, SD, rtol=0.15)
        for one, true in zip(found.views, truth, strict=True):
            np.testing.assert_allclose(one.vector, true.vector, atol=0.01)


def test_circles_alone_are_fitted_without_a_slide_along_them() -> None:
    rig, true = true_rig(), views(1)[0]
    rig[K1] = -0.1
    angle = np.linspace(-np.pi, np.pi, 3601)
    begin = View(true.vector + np.array([0.01, -0.02, 0.0, 0.02]))
    for seed in range(6):
        seen = marks(np.random.default_rng(seed), true.vector, rig, 0.1)
        seen = seen.pick(seen.line < CIRCLES)
        found = solve([seen], [begin], start_rig(OVERHEAD), SIZE, prior=OVERHEAD, view_sd=ROUND)
        # By their own linear residuals circles fitted with a free roll looked as good, 4 px off.
        radii = (HOUSE.twelve_foot, *found.rig[[R8, R4]])
        for line, radius in enumerate(radii):
            place = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
            curve = project(place, found.views[0].vector, found.rig, SIZE)
            away = np.linalg.norm(seen.pixel[seen.line == line][:, None] - curve, axis=2).min(1)
            assert np.median(away) < 0.4


def test_wrong_marks_are_told_and_do_not_pull() -> None:
    rng = np.random.default_rng(3)
    rig, truth = true_rig(), views(4)
    frames, wrong = [], []
    for view in truth:
        good = marks(rng, view.vector, rig, SD)
        wrong.append(rng.random(len(good)) < 0.1)
        off = good.normal * (rng.uniform(4, 8, (len(good), 1)) * wrong[-1][:, None])
        frames.append(replace(good, pixel=good.pixel + off))
    found = solve(
        frames, truth, start_rig(OVERHEAD), SIZE, prior=OVERHEAD, sharing=1.0, iterations=30
    )
    assert np.abs(found.rig - rig)[POSITION].max() < 0.15
    for inliers, not_one in zip(found.inliers, wrong, strict=True):
        assert not inliers[not_one].any()
        assert inliers[~not_one].mean() > 0.97


def test_shared_errors_let_the_prior_hold() -> None:
    rng = np.random.default_rng(5)
    rig, truth = true_rig(), views(1)
    frames = [marks(rng, truth[0].vector, rig, SD)]

    def strain(found: Solution) -> float:
        return float(np.linalg.norm((found.rig - OVERHEAD.mean) / OVERHEAD.sd))

    alone, shared = (
        solve(frames, truth, start_rig(OVERHEAD), SIZE, prior=OVERHEAD, sharing=sharing)
        for sharing in (1, 50)
    )
    assert strain(shared) < 0.95 * strain(alone)
