from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from curlshot.tests.helpers.vision.tracks import RED, YELLOW, Place, R, clip, detection
from curlshot.vision.association.follow import Track, follow
from curlshot.vision.association.naming import named_by_motion
from curlshot.vision.association.rejoin import rejoined


def ends(tracks: Sequence[Track]) -> list[tuple[float, float]]:
    return sorted((round(t.detections[-1].x, 1), round(t.detections[-1].y, 1)) for t in tracks)


@pytest.mark.parametrize("speed", [0.8, 2.0, 3.4])
@pytest.mark.parametrize("fps", [25.0, 50.0])
def test_a_full_hit_of_equal_stones_switches_nobody(speed: float, fps: float) -> None:
    hit = 1.013

    def thrown(t: float) -> Place:
        return (0.0, 2 * R + speed * max(hit - t, 0.0))

    def struck(t: float) -> Place:
        return (0.0, -speed * max(t - hit, 0.0))

    tracks = follow(clip([thrown, struck], 2.0, fps), R)
    assert len(tracks) == 2
    first = max(tracks, key=lambda track: track.detections[0].y)
    assert first.detections[-1].y == pytest.approx(2 * R, abs=0.02)
    assert [len(track.frames) for track in tracks] == [int(2 * fps)] * 2


@pytest.mark.parametrize(
    ("speed", "hidden"), [(1.0, (0.9, 1.5)), (2.0, (0.94, 1.3)), (3.0, (0.97, 1.06))]
)
def test_a_hit_that_nobody_saw_switches_nobody(speed: float, hidden: tuple[float, float]) -> None:
    hit, e = 1.0, 0.83

    def seen(t: float, y: float) -> Place | None:
        return None if hidden[0] < t < hidden[1] else (0.0, y)

    def thrown(t: float) -> Place | None:
        since = t - hit
        return seen(t, 2 * R - speed * (since if since < 0 else 0.5 * (1 - e) * since))

    def struck(t: float) -> Place | None:
        return seen(t, -0.5 * (1 + e) * speed * max(t - hit, 0.0))

    tracks = follow(clip([thrown, struck], 2.0), R)
    assert len(tracks) == 2
    first, other = sorted(tracks, key=lambda track: -track.detections[0].y)
    assert first.detections[-1].y == pytest.approx(2 * R - 0.5 * (1 - e) * speed, abs=0.02)
    assert other.detections[-1].y < -0.8 * speed


def test_three_stones_within_a_fifth_of_a_second() -> None:
    speed, first, second = 1.5, 1.0, 1.15
    gap = speed * (second - first)

    def a(t: float) -> Place:
        return (0.0, 2 * R + speed * max(first - t, 0))

    def b(t: float) -> Place:
        return (0.0, -speed * min(max(t - first, 0), second - first))

    def c(t: float) -> Place:
        return (0.0, -gap - 2 * R - speed * max(t - second, 0))

    tracks = follow(clip([a, b, c], 2.0), R)
    assert len(tracks) == 3
    by_name, rest = named_by_motion(tracks, R)
    assert not rest
    assert by_name["A"].detections[0].y > 1.5
    assert by_name["B"].detections[0].y == pytest.approx(0, abs=0.01)
    assert by_name["C"].detections[0].y == pytest.approx(-gap - 2 * R, abs=0.01)


def test_two_seconds_out_of_sight_keep_the_identity() -> None:
    def gliding(t: float) -> Place | None:
        place = (0.3 * t, 2.0 - 1.2 * t + 0.05 * t**2)
        return None if 1.0 < t < 3.0 else place

    def resting(t: float) -> Place | None:
        return None if 0.5 < t < 3.5 else (1.2, -1.0)

    tracks = follow(clip([gliding, resting]), R)
    assert len(tracks) == 2


def test_a_blip_is_no_stone_and_single_pictures_count() -> None:
    frames = clip([lambda t: (0.0, 0.0)], 2.0)
    frames[10][2].append(detection((1.0, 1.0)))
    frames[11][2].append(detection((1.0, 1.0)))
    assert len(follow(frames, R)) == 1
    assert len(follow([(0, 0.0, [detection((0, 0)), detection((1, 1))])], R)) == 2


@pytest.mark.parametrize("fps", [1.0, 0.1])
def test_pictures_may_be_seconds_apart(fps: float) -> None:
    frames = clip([lambda t: (0.0, 0.0), lambda t: (1.0, 0.5)], 6 / fps, fps)
    assert [len(track.frames) for track in follow(frames, R)] == [6, 6]


def test_a_newcomer_is_given_up_over_a_gap_as_long_as_pictures_are_close() -> None:
    frames = clip([lambda t: (0.0, 0.0) if not 0.1 < t < 1.5 else None], 2.5)
    assert [track.frames[0] for track in follow(frames, R)] == [38]


def test_colours_part_stones_that_swap_places_unseen() -> None:
    def first(t: float) -> Place | None:
        return (0.0, 0.0) if t < 1 else ((0.3, 0.0) if t > 1.4 else None)

    def second(t: float) -> Place | None:
        return (0.3, 0.0) if t < 1 else ((0.0, 0.0) if t > 1.4 else None)

    tracks = follow(clip([first, second], 3.0, colours=[RED, YELLOW]), R)
    for track in tracks:
        assert np.ptp([s.colour[2] for s in track.detections]) < 1


@pytest.mark.parametrize(("other", "count"), [(45.0, 1), (30.0, 2)])
def test_a_stone_of_another_team_comes_out_beside_where_one_went_out_of_sight(
    other: float, count: int
) -> None:
    """Red and orange caps are 40 apart, and so are their teams where no other is known."""
    orange = RED + np.array([69.0, -21.0, 26.0])
    paths = [
        lambda t: (0.0, 0.0) if t < 1 else None,
        lambda t: (0.27, 0.0) if t > 2 else None,
    ]  # fmt: skip
    frames = clip(paths, 3.0, colours=[RED, orange])
    assert len(rejoined(follow(frames, R, other=other), R, other)) == count


def test_what_looks_a_little_like_a_stone_for_a_moment_is_none() -> None:
    def seen(score: float, visible: float, frames: int, of: int = 100) -> int:
        shoulder = detection((1.0, 0.0), score=score)._replace(visible=visible)
        shown = [(i, i / 25, [shoulder] if i >= of - frames else []) for i in range(of)]
        return len(follow(shown, R, 1.1, 1.5))

    assert seen(1.2, 0.9, 10) == 0
    assert seen(1.2, 0.9, 30) == 1  # in the open for longer: dull, but it stays
    assert seen(1.2, 0.5, 10) == 1  # half covered it cannot show more
    assert seen(2.0, 0.9, 10) == 1
    assert seen(1.2, 0.9, 10, of=12) == 1  # in a clip so short everything is brief


@pytest.mark.parametrize(
    ("share", "visible", "kept"), [(0.3, 1.0, 0), (0.7, 1.0, 1), (0.3, 0.5, 1)]
)
def test_in_the_open_a_stone_looks_like_one_most_of_the_time(
    share: float, visible: float, kept: int
) -> None:
    """Paint does for some time, in a shadow; a stone that is half covered, now and then."""
    better = detection((1.0, 0.0), score=1.5)._replace(visible=visible)
    seen = [
        (i, i / 25, [better if i < 60 * share else better._replace(score=0.9)]) for i in range(60)
    ]
    assert len(follow(seen, R, 1.15, 1.5)) == kept


def test_what_looks_unchanged_is_no_more_evidence() -> None:
    def kept(measured: float, then: float) -> int:
        seen = [detection((1.0, 0.0), score=measured)] * 10 + [
            detection((1.0, 0.0), score=then)._replace(measured=i == 0) for i in range(60)
        ]
        return len(follow([(i, i / 25, [one]) for i, one in enumerate(seen)], R, 1.15, 1.5))

    assert kept(1.0, 1.2) == 0
    assert kept(1.0, 2.0) == 0  # one look in eleven
    assert kept(1.2, 1.2) == 1
    never = [(i, i / 25, [detection((1.0, 0.0))._replace(measured=False)]) for i in range(60)]
    assert follow(never, R, 1.15, 1.5) == []


def test_a_stone_that_a_jersey_half_covers_keeps_its_name() -> None:
    def covered(t: float) -> bool:
        return 1.0 < t < 2.0

    def resting(t: float) -> Place | None:
        return None if covered(t) else (0.5, 1.0)

    def jersey(t: float) -> Place | None:
        return (0.5, 1.02) if covered(t) else None

    def beside(t: float) -> Place | None:
        return (0.5, 1.0 + 2.1 * R) if covered(t) else None

    def to_the_end(t: float) -> Place | None:
        return (0.5, 1.0) if t > 1.0 else None

    def away(t: float) -> Place | None:
        return (0.5, 1.0) if t < 1.0 else None

    colours = [YELLOW, RED]
    (only,) = follow(clip([resting, jersey], colours=colours), R)
    assert np.ptp([s.colour[2] for s in only.detections]) < 1
    assert len(follow(clip([resting, beside], colours=colours), R)) == 2
    # One that stays where another one was before is another one.
    assert len(follow(clip([away, to_the_end], colours=colours), R)) == 2


def test_a_stone_that_somebody_covers_keeps_its_colour() -> None:
    """From 1 s on more and more of what is seen is a jersey; hidden, it comes out again."""
    frames = []
    for index in range(100):
        t = index / 25
        covered = float(np.clip((t - 1.0) / 0.5, 0, 1)) if t < 1.6 else 0.0
        colour = (1 - covered) * RED + covered * YELLOW
        one = detection((0.3, 0.4), colour)._replace(visible=0.3 if covered else 1.0)
        frames.append((index, t, [] if 1.6 <= t < 2.4 else [one]))
    assert len(rejoined(follow(frames, R), R)) == 1
    (track,) = follow(frames[:40], R)
    assert np.hypot(*(track.colour - RED)[1:]) < 0.3 * np.hypot(*(YELLOW - RED)[1:])
