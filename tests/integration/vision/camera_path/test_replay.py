from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from curlshot.synthetic import broadcast_camera, cached_clip, sample_scene
from curlshot.tests.helpers.vision.clip_marks import SIZE
from curlshot.vision.camera_path.follow_house import HouseFollower
from curlshot.vision.camera_path.replay import (
    CELLS,
    Glimpse,
    cut_among,
    has_jumped,
    is_nearer,
    is_replay,
    shows_again,
)
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.reader import open_video

RATE = 25


@pytest.fixture(scope="module")
def live() -> list[np.ndarray]:
    """Pictures of a shot that runs through the house."""
    file, _ = cached_clip(sample_scene(), broadcast_camera(), duration=3.0)
    return [frame.image for frame in open_video([file])]


def frames(parts: Sequence[Sequence[np.ndarray]]) -> list[int]:
    """Follow parts with crowds between them; the indices of the frames that have a camera."""
    rng = np.random.default_rng(2)
    crowd = rng.integers(0, 256, (8, *SIZE[::-1], 3), dtype=np.uint8)
    return frames_of([p for k, part in enumerate(parts) for p in ([*crowd] if k else []) + [*part]])


def frames_of(pictures: Sequence[np.ndarray]) -> list[int]:
    """Follow pictures; the indices of the frames that have a camera in the end."""
    follower = HouseFollower(SIZE)
    for k, picture in enumerate(pictures):
        follower.look(Frame(k, k / RATE, picture))
    track = follower.finish()
    assert track is not None
    return [c.frame for c in track.cameras]


def test_only_what_shows_the_same_ice_is_compared() -> None:
    house = np.random.default_rng(4).uniform(0, 255, (CELLS, CELLS))
    low, high = house.copy(), house + 6.0
    low[: CELLS * 3 // 4], high[CELLS // 2 :] = np.nan, np.nan
    first, last = Glimpse(0.0, Cached(high)), Glimpse(2.0, Cached(low))
    assert not is_replay(Glimpse(2.2, Cached(high + 1.0)), [first, last])
    assert is_replay(Glimpse(2.2, Cached(high + 1.0)), [first, Glimpse(2.0, Cached(house))])


def house(*things: tuple[int, int], t: float = 0.0) -> Glimpse:
    """A glimpse of a house with dark things on it, each of three cells by three."""
    grey = np.full((CELLS, CELLS), 200.0)
    for row, column in things:
        grey[row : row + 3, column : column + 3] = 60.0
    return Glimpse(t, Cached(grey))


A, B, C, D = (5, 8), (30, 12), (14, 40), (40, 33)


def test_it_has_jumped_where_several_things_are_elsewhere() -> None:
    assert has_jumped(house(A, B), house(C, D))
    assert not has_jumped(house(A, B), house(A, B))
    assert not has_jumped(house(A, B), house(A, (30, 14)))  # one has moved a little


def test_a_cut_changes_all_at_once_and_what_moves_step_by_step() -> None:
    assert cut_among([house(A, B), house(A, B), house(C, D), house(C, D)]) == 2
    assert cut_among([house((5, 9 + k), (30, 20 + k)) for k in range(4)]) is None


def test_what_was_there_once_is_shown_again_but_not_what_is_usual() -> None:
    before = [house(A, B), house(C, D), house(C, D), house(C, D)]
    assert shows_again(house(A, B), before, before[:1])
    assert not shows_again(house(A, B), before, [house((20, 20), (9, 25))])
    # People who go uncover what was there before.
    covered = [house(), house(), house(), house(A, B)]
    assert not shows_again(house(), covered, covered[:1])


def test_what_is_shown_again_are_things_not_ice_that_was_covered_for_long() -> None:
    radius = np.hypot(*(np.indices((CELLS, CELLS)) - (CELLS - 1) / 2))
    paint = np.select([radius < 8, radius < 16, radius < 24], [120.0, 210.0, 90.0], 205.0)
    paint[:, 12] = 150.0  # a line

    def seen(*things: tuple[int, int]) -> Glimpse:
        grey = paint.copy()
        for row, column in things:
            grey[row : row + 5, column : column + 5] = 60.0 if paint[row, column] > 100 else 200.0
        return Glimpse(0.0, Cached(grey))

    long_before, people = [seen(), seen(C)], [seen(A, B, (20, 28))] * 5
    assert not shows_again(seen(), [*long_before, *people], long_before)
    assert shows_again(seen(C, D), [*long_before, *people], [seen(C, D)])


def test_things_are_known_where_they_are() -> None:
    """An opening that shifts loses three of the four cells of each."""
    small = [(5, 8), (30, 12)]

    def seen(*things: tuple[int, int]) -> Glimpse:
        grey = np.full((CELLS, CELLS), 200.0)
        for row, column in things:
            grey[row : row + 2, column : column + 2] = 60.0
        return Glimpse(0.0, Cached(grey))

    assert shows_again(seen(*small), [seen(), seen(), seen()], [seen(*small)])


def test_the_nearer_is_the_one_that_differs_less() -> None:
    assert is_nearer(house(A, B), [house(C, D), house(A, B)], house(A, D))
    assert not is_nearer(house(A, B), [house(C, D)], house(A, B))


def test_what_goes_on_after_a_cut_belongs_to_the_shot(live: list[np.ndarray]) -> None:
    assert frames([live[:45], live[53:]]) == [*range(45), *range(53, 75)]


@pytest.mark.parametrize("start", [8, 21])
def test_a_replay_does_not(live: list[np.ndarray], start: int) -> None:
    assert frames([live, live[start : start + 30]]) == list(range(len(live)))


def test_the_shot_may_go_on_after_a_replay(live: list[np.ndarray]) -> None:
    first, second = live[:50], live[60:]
    found = frames([first, live[6:26], second])
    assert found == [*range(50), *range(50 + 36, 50 + 36 + len(second))]


def test_a_replay_without_a_gap_is_told_by_what_is_seen(live: list[np.ndarray]) -> None:
    found = frames_of([*live, *live[8:38]])
    assert found == list(range(found[-1] + 1))
    assert len(live) - 6 <= found[-1] < len(live)


def test_the_shot_may_go_on_after_a_replay_without_a_gap(live: list[np.ndarray]) -> None:
    found = frames_of([*live[:50], *live[6:26], *live[51:]])
    assert not set(found) & set(range(50, 70))
    assert {*range(44), *range(76, 94)} <= set(found)
