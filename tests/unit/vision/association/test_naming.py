from __future__ import annotations

import pytest

from curlshot.tests.helpers.vision.tracks import R, clip
from curlshot.vision.association.follow import follow
from curlshot.vision.association.naming import first_motion, named_by_motion


def test_jitter_is_no_motion_and_a_start_is_timed_to_a_frame() -> None:
    still = follow(clip([lambda t: (0.5, 0.5)], noise=0.004), R)
    assert first_motion(still[0], R) is None
    moved = follow(clip([lambda t: (0.5, 0.5 - 1.1 * max(t - 1.73, 0))]), R)
    start = first_motion(moved[0], R)
    assert start is not None
    assert start == pytest.approx(1.73, abs=0.02)


def test_a_stone_that_enters_moving_moves_from_its_first_frame() -> None:
    tracks = follow(clip([lambda t: (0.0, 4 - 1.5 * t) if t > 0.5 else None], 2.0), R)
    assert first_motion(tracks[0], R) == pytest.approx(tracks[0].times[0])


def test_resting_stones_are_named_by_their_distance_to_the_tee() -> None:
    paths = [lambda t: (1.5, 0.0), lambda t: (0.0, 0.2), lambda t: (0.0, 2.0 - t)]
    tracks = follow(clip(paths, 1.0), R)
    named, rest = named_by_motion(tracks, R)
    assert rest == ("B", "C")
    start = {name: track.detections[0] for name, track in named.items()}
    assert start["A"].y == pytest.approx(2, abs=0.01)
    assert start["B"].y == pytest.approx(0.2, abs=0.01)
    assert start["C"].x == pytest.approx(1.5, abs=0.01)
