from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.cameras import SIZE, marks, true_rig, views
from curlshot.vision.optics.linear import Observations, by_measure, by_rig, linearised
from curlshot.vision.optics.paint import MEASURED, joined
from curlshot.vision.optics.pose import VIEW_SIZE
from curlshot.vision.optics.rig import RIG_SIZE


def test_derivatives_are_those_of_the_residuals() -> None:
    rng = np.random.default_rng(1)
    rig, view = true_rig(), views(1)[0].vector
    observed = Observations(marks(rng, view, rig, 1.0), SIZE)

    def residuals(v: np.ndarray, r: np.ndarray) -> np.ndarray:
        return linearised(observed, observed.points(r), v, r).residual

    at = linearised(observed, observed.points(rig), view, rig)
    shared = by_rig(observed, at, view)
    for i in range(VIEW_SIZE):
        step = np.eye(VIEW_SIZE)[i] * 1e-6
        change = (residuals(view + step, rig) - residuals(view - step, rig)) / 2e-6
        np.testing.assert_allclose(at.by_view[i], change, rtol=1e-5, atol=1e-3)
    for i in range(RIG_SIZE):
        step = np.eye(RIG_SIZE)[i] * 1e-6
        change = (residuals(view, rig + step) - residuals(view, rig - step)) / 2e-6
        np.testing.assert_allclose(shared[i], change, rtol=1e-5, atol=1e-3)


def test_frames_together_give_what_each_gives_alone() -> None:
    rng = np.random.default_rng(2)
    rig, some = true_rig(), np.array([v.vector for v in views(3)])
    frames = [marks(rng, v, rig, 1.0) for v in some]
    frames[1] = frames[1].pick(np.arange(7))
    every = Observations(joined(frames), SIZE, counts=[len(m) for m in frames])
    at = linearised(every, every.points(rig), some, rig)
    shared = by_rig(every, at, some)
    total = every.summed(at.residual)
    for m, view, part, sum_ in zip(frames, some, every.parts, total, strict=True):
        observed = Observations(m, SIZE)
        alone = linearised(observed, observed.points(rig), view, rig)
        np.testing.assert_allclose(at.residual[part], alone.residual)
        np.testing.assert_allclose(at.by_view[:, part], alone.by_view)
        np.testing.assert_allclose(shared[:, part], by_rig(observed, alone, view))
        np.testing.assert_allclose(sum_, alone.residual.sum())


def test_a_mark_follows_the_measure_of_its_own_line() -> None:
    rng = np.random.default_rng(3)
    rig, view = true_rig(), views(1)[0].vector
    observed = Observations(marks(rng, view, rig, 1.0), SIZE)
    at = linearised(observed, observed.points(rig), view, rig)
    column = MEASURED[observed.line]
    unknown = np.flatnonzero(column >= 0)
    of_rig = by_rig(observed, at, view)[column[unknown], unknown]
    np.testing.assert_allclose(by_measure(observed, at)[unknown], of_rig)


def test_what_is_behind_the_camera_pulls_nowhere() -> None:
    rng = np.random.default_rng(4)
    rig, view = true_rig(), views(1)[0].vector
    seen = marks(rng, view, rig, 1.0)
    behind = view.copy()
    behind[0] += np.pi
    observed = Observations(seen, SIZE)
    at = linearised(observed, observed.points(rig), behind, rig)
    assert (at.residual > 1e5).all()
    assert not at.by_view.any()
