"""Stones have handles, and a team's are alike: what has none among them is no stone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import nan

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.tests.helpers.vision.reliefs import bar, cap
from curlshot.tests.helpers.vision.tracks import RED, YELLOW, detection
from curlshot.vision.association.bare import bare, contrast_of, with_handles
from curlshot.vision.association.follow import Track
from curlshot.vision.detection.appearance import BY_SHAPE, Colour
from curlshot.vision.detection.relief import contrast
from curlshot.vision.detection.stones import plain_disc
from curlshot.vision.video.disk_cache import Cached

TEAMS = replace(BY_SHAPE, caps=(Colour(RED, np.eye(3)), Colour(YELLOW, np.eye(3))))


def track_of(
    caps: Sequence[NDArray[np.complex64] | None],
    colour: NDArray[np.float64] = RED,
    step: float = 0.0,
    pixel: float = 0.01,
) -> Track:
    track = Track()
    for frame, spectrum in enumerate(caps):
        shown = None if spectrum is None else Cached(spectrum)
        seen = detection((1.0, step * frame), colour)._replace(spectrum=shown, pixel_size=pixel)
        track.add(frame, frame / 25, seen, STONE.radius)
    return track


@pytest.mark.parametrize(
    ("shown", "team", "without"),
    [
        ([20, 18, 1], [0, 0, 0], [False, False, True]),  # paint of a team's colour
        ([20, 18, 3.5], [0, 0, 0], [False, False, True]),  # with a ring within it
        ([9, 9, 3.3], [0, 0, 0], [False, False, True]),  # as much of theirs as paint may have
        ([30, 30, 5, 3.5], [0] * 4, [False] * 3 + [True]),  # one of them is seen badly
        ([20, 18, 6], [0, 0, 0], [False, False, False]),  # that is seen, however faintly
        ([8, 7, 3.5], [0, 0, 0], [False, False, False]),  # as far off as real stones are
        ([3, 3.5, 1], [0, 0, 0], [False, False, False]),  # in the caps' colour: what is faint?
        ([30, 28, 1], [0, 0, 1], [False, False, True]),  # alone in its colour
        ([30, 28, 3.5], [0, 0, 1], [False, False, False]),  # whose handles may be faint
        ([30, 28, 8, 1.5], [0, 0, 0, 1], [False] * 4),  # as one of the others
        ([1, 0.5], [0, 1], [False, False]),  # drawn without handles
        ([20, nan], [0, 0], [False, False]),  # not seen
        ([20, -1], [0, 0], [False, True]),
        ([20, 18, 19, 40, 2], [0, 0, 0, 0, 1], [False] * 5),
        ([], [], []),
    ],
)
def test_what_shows_far_less_than_a_handle_has_none(
    shown: list[float], team: list[int], without: list[bool]
) -> None:
    assert bare(shown, team, [False] * len(shown)).tolist() == without


def test_of_a_team_that_moves_but_shows_no_handle_none_is_paint() -> None:
    shown, still = [27.0, 25.0, 1.5, 1.4], [False] * 4
    assert bare(shown, [0, 0, 1, 1], still).tolist() == [False, False, True, True]
    assert not bare(shown, [0, 0, 1, 1], [False, False, True, False]).any()
    # Beside stones whose handles are seen a graphic may seem to glide, where a camera pans.
    pans, others = [False, False, True, True], [True, True, False, False]
    for team, moved in (([0, 0, 0, 0], pans), ([0, 0, 1, 1], others)):
        assert bare(shown, team, moved).tolist() == [False, False, True, True]


def test_what_moves_says_how_faint_handles_of_its_team_may_be() -> None:
    # Those of the caps' own colour show by their shades, and at some places hardly.
    still, goes = [False] * 4, [False, False, True, False]
    assert bare([8, 3, 2.9, 1.1], [0] * 4, still).tolist() == [False, True, True, True]
    assert bare([8, 3, 2.9, 1.1], [0] * 4, goes).tolist() == [False, False, False, True]
    assert not bare([8, 8, 2.9, 8], [0] * 4, goes).any()  # a stone that was thrown
    assert bare([8, 8, 1.3, 8], [0] * 4, goes).tolist() == goes  # an icon
    assert bare([8, 3.5, nan, 3], [0] * 4, goes).tolist() == [False] * 3 + [True]


def test_a_disc_of_paint_among_stones_is_left_out() -> None:
    stones = [track_of([cap(bar(30, 0.1 * k), 3.0, k) for k in range(20)]) for _ in range(2)]
    paint = track_of([cap(bar(0), 3.0, k) for k in range(20)])
    alone = track_of([cap(bar(0), 3.0, k) for k in range(20)], YELLOW)
    assert with_handles([*stones, paint, alone], TEAMS, STONE) == stones
    assert with_handles([paint, alone], TEAMS, STONE) == [paint, alone]
    assert with_handles([], TEAMS, STONE) == []
    assert with_handles([*stones, paint], TEAMS, plain_disc(0.05)) == [*stones, paint]
    assert with_handles([*stones, paint], None, STONE) == [*stones, paint]
    faint = track_of([cap(bar(0), 3.0, k) for k in range(20)], YELLOW, step=0.02)
    assert with_handles([*stones, alone, faint], TEAMS, STONE) == [*stones, alone, faint]


def test_a_stone_that_spins_fast_before_a_slow_camera_has_its_handle() -> None:
    stones = [track_of([cap(bar(30, 0.3), 3.0, k) for k in range(20)]) for _ in range(2)]
    spins = track_of([cap(bar(30, 0.9 * k), 3.0, k) for k in range(20)], step=0.05)
    glides = track_of([cap(bar(0), 3.0, k) for k in range(20)], step=0.05)
    assert with_handles([*stones, spins, glides], TEAMS, STONE) == [*stones, spins]


def test_what_goes_over_a_disc_for_some_time_is_no_handle() -> None:
    covered = [cap(60 * bar(1, 0.3, 0.05)) for _ in range(15)]
    disc = [cap(bar(0), 3.0, k) for k in range(45)]
    assert contrast_of(track_of([*disc[:20], *covered, *disc[20:]]), contrast) < 1
    assert contrast_of(track_of([*disc[:20], *covered, *disc[20:30], *covered[:5]]), contrast) < 1


def test_of_hardly_seen_and_of_tiny_caps_nothing_is_told() -> None:
    twice = track_of([None, cap(bar(30)), None, cap(bar(30)), None])
    assert np.isnan(contrast_of(twice, contrast))
    for pixel, told in ((0.02, True), (0.03, False)):
        small = track_of([cap(bar(30))] * 20, pixel=pixel)
        assert np.isfinite(contrast_of(small, contrast)) == told
    assert contrast_of(track_of([None, *[cap(bar(30))] * 3]), contrast) > 5


def test_of_a_track_of_one_picture_that_picture_tells() -> None:
    stone, paint = track_of([cap(bar(30), 1.0)]), track_of([cap(bar(0), 1.0)], YELLOW)
    long = track_of([cap(bar(30, 0.1 * k), 1.0, k) for k in range(20)])
    assert with_handles([stone, paint], TEAMS, STONE) == [stone]
    assert with_handles([long, paint], TEAMS, STONE) == [long]
    assert with_handles([paint], TEAMS, STONE) == [paint]


@pytest.mark.parametrize("clear", [0, 1])
def test_a_stone_that_is_covered_in_one_of_two_pictures_stays(clear: int) -> None:
    stone, paint = track_of([cap(bar(30), 1.0)] * 2), track_of([cap(bar(0), 1.0)] * 2, YELLOW)
    shown = [cap(bar(30 * (k == clear)), 1.0) for k in range(2)]
    covered = track_of(shown, YELLOW)
    assert with_handles([stone, covered, paint], TEAMS, STONE) == [stone, covered]
