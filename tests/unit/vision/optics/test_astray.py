from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.cameras import SIZE, marks, true_rig
from curlshot.vision.optics.astray import COPIED, LASTING, MUCH, NONE, REPEATED, astray, motion
from curlshot.vision.optics.linear import Observations, linearised
from curlshot.vision.optics.paint import joined
from curlshot.vision.optics.rig import POSITION

RIG = true_rig()
SQUARE_ON = np.array([0.0, 0.0, 0.0, np.log(1200.0)])


def moved(views: np.ndarray, every: int = 1, glide: float = 0.0) -> np.ndarray:
    rng = np.random.default_rng(0)
    seen = [marks(rng, view, RIG, 0.0) for view in views]
    frames = [m.pick(m.line < 3) for m in seen]  # normals all around
    observed = Observations(joined(frames), SIZE, counts=[len(m) for m in frames])
    at = linearised(observed, observed.points(RIG), views, RIG)
    number = np.arange(len(views))
    places = RIG[POSITION] + np.outer(number, [glide, 0.0, 0.0])
    return motion(observed, at, views, places, every * number)


def test_a_turn_moves_the_picture_by_the_focal_length_times_its_angle() -> None:
    steps = np.outer(np.arange(6), [2e-3, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(moved(SQUARE_ON + steps), 2.4, rtol=0.15)
    np.testing.assert_allclose(moved(SQUARE_ON + steps, every=3), 0.8, rtol=0.15)


def test_a_camera_that_turns_to_what_it_glides_past_hardly_moves_the_picture() -> None:
    glide = 2e-3 * RIG[POSITION][2]
    there = np.outer(np.arange(6), [0.0, 2e-3, 0.0, 0.0])
    np.testing.assert_allclose(moved(SQUARE_ON + 0 * there, glide=glide), 2.4, rtol=0.15)
    assert (moved(SQUARE_ON + there, glide=glide) < 0.15).all()


def test_motion_is_that_of_the_time_about_a_frame_and_none_of_one_alone() -> None:
    views = np.repeat(SQUARE_ON[None], 12, axis=0)
    views[6:, 0] += 1e-3
    found = moved(views)
    assert (found[4:8] > 0.4).all()
    assert not found[:4].any() and not found[8:].any()
    assert moved(SQUARE_ON[None]) == [0.0]


def test_pictures_that_hardly_move_are_aside_by_most_and_those_that_rest_by_nothing() -> None:
    def aside(motion: float) -> float:
        return float(astray(0.1 * np.full(3, motion), np.full(3, 0.1))[1])

    assert aside(0.0) == 0
    assert aside(1.0) == pytest.approx(0.1 * (COPIED + REPEATED), rel=0.1)
    assert aside(100 * MUCH) == pytest.approx(0.1 * COPIED, rel=0.01)
    assert 0 < aside(NONE) < aside(1.0)
    assert astray(np.ones(1), np.array([np.nan])) == [0.0]


def test_a_film_that_stands_while_a_camera_begins_to_move_or_stops_is_aside() -> None:
    step = np.where(np.arange(60) == 30, 0.1, 0.0)
    found = astray(step, np.full(60, 0.1))
    near = np.abs(np.arange(60) - 30) <= LASTING
    assert (found[near] > 0.07 * (COPIED + REPEATED)).all()
    assert not found[~near].any()
