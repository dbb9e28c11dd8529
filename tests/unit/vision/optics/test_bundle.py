from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from curlshot.tests.helpers.vision.cameras import SIZE, marks, true_rig, views
from curlshot.vision.optics.bundle import FAMILIES, PAINT_SD, _is_cropped, _Problem, _State, bundle
from curlshot.vision.optics.paint import CIRCLES, Marks
from curlshot.vision.optics.pose import View
from curlshot.vision.optics.resection import solve_view
from curlshot.vision.optics.rig import OVERHEAD, POSITION, R4, R8, RIG_SIZE, start_rig
from curlshot.vision.optics.shared import Bundle

VIEWS = [View(np.array([0.19, -0.02 * k, 0.03, 7.1 + 0.01 * k])) for k in range(5)]


@pytest.mark.parametrize("height", [6.5, 8.5, 12.0, 19.0])
def test_the_height_does_not_depend_on_where_the_fit_begins(height: float) -> None:
    rng = np.random.default_rng(4)
    rig = true_rig()
    frames = [marks(rng, view.vector, rig, 0.1) for view in VIEWS]
    start = start_rig(OVERHEAD, (0.0, 0.0, height))
    begin = [
        solve_view(seen, view, start, SIZE).view for seen, view in zip(frames, VIEWS, strict=True)
    ]
    found, fitted = bundle(frames, np.arange(len(VIEWS)) / 25, begin, start, SIZE, OVERHEAD)
    sd = np.sqrt(np.diag(found.cov))
    known = [*range(*POSITION.indices(3)), R8, R4]
    assert (np.abs(found.rig - rig)[known] < 4 * sd[known]).all()
    assert sd[2] < 0.2
    for view, true in zip(fitted, VIEWS, strict=True):
        assert abs(view.vector[3] - true.vector[3]) < 4 * sd[2] / rig[2]


@pytest.mark.parametrize("speed", [0.0, 0.2])
def test_a_camera_moves_only_if_the_marks_say_so(speed: float) -> None:
    rng = np.random.default_rng(5)
    times, frames = np.linspace(0.0, 1.0, 8), []
    for t, view in zip(times, views(8), strict=True):
        rig = true_rig()
        rig[0] += speed * (t - 0.5)
        frames.append(marks(rng, view.vector, rig, 0.1))
    found, _ = bundle(frames, times, views(8), start_rig(OVERHEAD), SIZE, OVERHEAD)
    assert bool(len(found.travel)) == bool(speed)
    moved = found.moved(times)
    np.testing.assert_allclose(moved[:, 0], speed * (times - 0.5), atol=0.02)


@pytest.mark.parametrize("axis", [(0.0, 0.0), (0.15, 0.0), (-0.1, 0.2)])
def test_an_axis_off_the_middle_of_the_picture_is_found(axis: tuple[float, float]) -> None:
    rng = np.random.default_rng(8)
    aside = np.hypot(*SIZE) / 2 * np.array(axis)
    frames = [marks(rng, view.vector, true_rig(), 0.1) for view in views(8)]
    frames = [replace(m, pixel=m.pixel + aside) for m in frames]
    times, start = np.arange(8) / 25, start_rig(OVERHEAD)
    begin = [solve_view(m, v, start, SIZE).view for m, v in zip(frames, views(8), strict=True)]
    found, fitted = bundle(frames, times, begin, start, SIZE, OVERHEAD)
    assert found.cropped == any(axis)
    problem = _Problem(frames, np.zeros((8, 0)), fitted, SIZE, OVERHEAD)
    at = np.array([view.vector for view in fitted])
    state = _State(found.rig, np.zeros((0, 3)), found.offset, at)
    _, told = problem.aside(state, PAINT_SD, found.noise)
    np.testing.assert_allclose(told, axis, atol=0.08)


def fitted(frames: list[Marks], views: list[View], start: np.ndarray) -> Bundle:
    times = np.arange(len(frames)) / 25
    begin = [solve_view(m, v, start, SIZE).view for m, v in zip(frames, views, strict=True)]
    return bundle(frames, times, begin, start, SIZE, OVERHEAD)[0]


@pytest.mark.parametrize(("ragged", "told"), [(0.002, False), (0.012, True)])
def test_lines_more_crooked_than_painted_ones_are_told(ragged: float, told: bool) -> None:
    rng, frames = np.random.default_rng(9), []
    for view in views(8):
        seen = marks(rng, view.vector, true_rig(), 0.1)
        bent = np.where(seen.line < CIRCLES, 0, np.sin(seen.along * 9 + seen.line))
        scale = view.focal / true_rig()[POSITION][2]
        away = np.sqrt(2) * ragged * scale * bent[:, None] * seen.normal
        frames.append(replace(seen, pixel=seen.pixel + away))
    assert fitted(frames, views(8), start_rig(OVERHEAD)).cropped == told


@pytest.mark.parametrize(("height", "told"), [(17.0, False), (24.0, True)])
def test_a_camera_higher_than_any_hangs_is_told(height: float, told: bool) -> None:
    rng, rig = np.random.default_rng(9), true_rig()
    rig[POSITION] = 0.1, 0.2, height
    high = [View(view.vector + np.log(height / 9.4) * np.eye(4)[3]) for view in views(8)]
    frames = [marks(rng, view.vector, rig, 0.1) for view in high]
    assert fitted(frames, high, start_rig(OVERHEAD)).cropped == told


def test_a_step_that_ends_below_the_ice_is_no_end() -> None:
    rng = np.random.default_rng(6)
    rig, view = true_rig(), VIEWS[0]
    problem = _Problem(
        [marks(rng, view.vector, rig, 0.1)], np.zeros((1, 0)), [view], SIZE, OVERHEAD
    )
    above = _State(rig, np.zeros((0, 3)), np.zeros(len(problem.pieces)), view.vector[None])
    below = rig.copy()
    below[POSITION] = 0.0, 1.7, -1.4
    state = _State(below, above.travel, above.offset, above.views)
    noise = np.ones(FAMILIES)
    state = problem.settled(state, problem.see(state), noise)
    costs = [problem.cost(s, problem.see(s), PAINT_SD, noise) for s in (above, state)]
    assert np.isfinite(state.views).all() and costs[1] > costs[0]


@pytest.mark.parametrize(
    ("far", "gain", "cropped"),
    [(0.06, 60.0, True), (0.04, 60.0, False), (0.06, 40.0, False),
     (0.12, 30.0, True), (0.08, 30.0, False), (0.30, 15.0, False)],
)  # fmt: skip
def test_an_axis_is_aside_if_it_is_far_enough_and_sure_enough(
    far: float, gain: float, cropped: bool
) -> None:
    rig = np.zeros(RIG_SIZE)
    rig[POSITION] = 0.0, 0.0, 8.0
    problem = SimpleNamespace(
        aside=lambda *_: (gain, far * np.array([0.6, -0.8])), pixel=lambda *_: 0.005
    )
    state = SimpleNamespace(rig=rig)
    assert _is_cropped(problem, state, PAINT_SD, np.ones(FAMILIES)) is cropped  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("ragged", "pixel", "cropped"),
    [(0.004, 0.005, False), (0.006, 0.005, True), (0.006, 0.016, False), (0.009, 0.016, True)],
)
def test_lines_are_crooked_by_more_than_a_pixel_tells(
    ragged: float, pixel: float, cropped: bool
) -> None:
    """The hog line of a club's small picture was ragged by 7 mm, 0.4 px."""
    rig = np.zeros(RIG_SIZE)
    rig[POSITION] = 0.0, 0.0, 6.0
    problem = SimpleNamespace(aside=lambda *_: (0.0, np.zeros(2)), pixel=lambda *_: pixel)
    paint = np.array([0.001, ragged, 1.0])
    state = SimpleNamespace(rig=rig)
    assert _is_cropped(problem, state, paint, np.ones(FAMILIES)) is cropped  # type: ignore[arg-type]
