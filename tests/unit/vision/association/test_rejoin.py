from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.tracks import (
    RED,
    YELLOW,
    Place,
    R,
    clip,
    detection,
)
from curlshot.vision.association.follow import follow
from curlshot.vision.association.rejoin import _Motion, rejoined

LOST, BACK = 1.0, 2.6
"""When the stone goes out of sight, and comes back, s."""


RESTS = 3.6
"""When it has come to rest, s."""


def thrown(t: float) -> Place | None:
    return (0.2, 3.0 - 1.4 * t) if t < LOST else None


def coming_back(start: Place, vx: float = 0.35, vy: float = -0.3) -> object:
    def path(t: float) -> Place | None:
        """Hit at `start` when it was lost; it slows as stones do."""
        way = t - LOST - 0.05 * (t - LOST) ** 2 / 0.46
        return (start[0] + vx * way, start[1] + vy * way) if t > BACK else None

    return path


@pytest.mark.parametrize(
    ("start", "colour", "stones"),
    [
        ((0.2, 1.6), RED, 1),
        ((0.2, 1.6), YELLOW, 2),
        ((-1.0, 2.5), RED, 2),
    ],
    ids=["it was hit there", "of the other team", "from elsewhere"],
)
def test_what_comes_back_from_where_a_stone_was_lost_is_that_stone(start, colour, stones) -> None:
    frames = clip([thrown, coming_back(start)], colours=[RED, colour])  # type: ignore[list-item]
    tracks = follow(frames, R)
    assert len(tracks) == 2
    joined = rejoined(tracks, R)
    assert len(joined) == stones
    assert sum(len(track.frames) for track in joined) == sum(len(seen) for _, _, seen in frames)
    assert all(track.times == sorted(track.times) for track in joined)


def test_a_stone_that_was_covered_before_it_was_lost_keeps_its_colour() -> None:
    """For half a second all that is seen of it is a jersey."""

    def guard(t: float) -> Place | None:
        return (0.2, 1.6) if t < LOST else None

    frames = [
        (
            index,
            t,
            [s._replace(colour=YELLOW, visible=0.35) if 0.5 <= t < LOST else s for s in seen],
        )
        for index, t, seen in clip([guard, coming_back((0.2, 1.6))], seconds=BACK + 0.3)
    ]
    tracks = follow(frames, R)
    assert len(tracks) == 2
    (joined,) = rejoined(tracks, R)
    assert np.hypot(*(joined.colour - RED)[1:]) < 0.2 * np.hypot(*(YELLOW - RED)[1:])


@pytest.mark.parametrize(
    ("start", "hit", "stones"),
    [((0.2, 0.4), 2.0, 1), ((0.2, 0.4), 0.4, 2), ((0.9, 0.4), 2.0, 2)],
    ids=["hit behind the sweeper", "passed where it was still seen", "from beside it"],
)
def test_a_stone_at_rest_that_was_hit_behind_a_sweeper_goes_on(start, hit, stones) -> None:
    def guard(t: float) -> Place | None:
        return (0.2, 0.4) if t < LOST else None

    def struck(t: float) -> Place | None:
        return (start[0] + 0.5 * (t - hit), start[1] - (t - hit)) if t > BACK else None

    tracks = follow(clip([guard, struck], seconds=4.0), R)
    assert len(tracks) == 2
    assert len(rejoined(tracks, R)) == stones


def test_a_stone_that_came_back_and_rests_does_not_glide_on() -> None:
    way = coming_back((0.2, 1.6))

    def resting(t: float) -> Place | None:
        return way(min(t, RESTS)) if BACK < t < 5.0 else None

    def another(t: float) -> Place | None:
        x, y = way(RESTS)
        return (x + 0.5 * (t - 4.0), y + 0.9 * (t - 4.0)) if t > 6.0 else None

    tracks = follow(clip([thrown, resting, another], seconds=8.0), R)
    first, rest, new = tracks
    assert first.speed > 1.0 and rest.speed == 0.0
    joined = rejoined(tracks, R)
    assert [track.times[0] for track in joined] == [0.0, new.times[0]]
    assert joined[0].times[-1] == rest.times[-1]


def glide(start: np.ndarray, velocity: np.ndarray, t: float) -> np.ndarray:
    """Place of a stone that slows by 0.1 m/s² from the time 0 on, until it rests."""
    speed = float(np.hypot(*velocity))
    t = min(t, speed / 0.1)
    return np.asarray(start + velocity * (t - 0.05 * t**2 / speed)) if t else start


@pytest.mark.parametrize("aside", [0.0, 0.4, -1.2, 1.8], ids=lambda aside: f"{aside} R")
@pytest.mark.parametrize("speed", [0.7, 1.8])
@pytest.mark.parametrize("back", [2.2, 3.7])
def test_two_equal_stones_that_meet_out_of_sight_keep_their_names(aside, speed, back) -> None:
    """One rests, the other comes, and people hide both from before the hit to long after it."""
    hit, e, down = 1.5, 0.82, np.array([0.0, -1.0])
    normal = np.array([-aside / 2, -np.sqrt(1 - aside**2 / 4)])
    push = 0.5 * (1 + e) * speed * float(normal @ down) * normal
    met = -2 * R * normal

    def thrown(t: float) -> Place | None:
        before = met - down * ((speed + 0.05 * (hit - t)) * (hit - t))
        place = before if t < hit else glide(met, speed * down - push, t - hit)
        return None if LOST < t < back else tuple(place)

    def struck(t: float) -> Place | None:
        place = np.zeros(2) if t < hit else glide(np.zeros(2), push, t - hit)
        return None if LOST < t < back else tuple(place)

    tracks = rejoined(follow(clip([thrown, struck], seconds=5.0), R), R)
    assert len(tracks) == 2
    for track in tracks:
        path = thrown if track.detections[0].y > 0.1 else struck
        off = [np.hypot(*np.subtract(path(t), (s.x, s.y))) for t, s in zip(
            track.times, track.detections, strict=True)]  # fmt: skip
        assert max(off) < 0.05


@pytest.mark.parametrize(
    ("aside", "y", "back"), [(0.3, 0.4, 1.8), (-0.4, 0.4, 1.8), (0.25, 1.0, 1.5)]
)
def test_a_stone_uncovered_beside_the_way_of_one_that_is_not_seen_again_is_another(
    aside, y, back
) -> None:
    def uncovered(t: float) -> Place | None:
        return (0.2 + aside, y) if t > back else None

    tracks = follow(clip([thrown, uncovered]), R)
    assert len(tracks) == 1  # it is expected about there
    assert len(rejoined(tracks, R)) == 2


def turning(hit: float, lost: float, velocity: tuple[float, float]) -> object:
    """Way of a stone that comes down, is hit by another one, and is out of sight for long."""
    came = np.array([0.0, -1.5])

    def path(t: float) -> Place | None:
        here = glide(np.array([0.2, 3.0]), came, min(t, hit))
        if t > hit:
            here = glide(here, np.array(velocity), t - hit)
        return None if lost < t < 2.8 else tuple(here)

    return path


@pytest.mark.parametrize("velocity", [(0.9, -0.4), (-0.5, -0.3), (0.15, -0.1), (0.27, 0.0)])
@pytest.mark.parametrize("hit", [1.1, 1.6, 2.2])
def test_a_stone_may_be_hit_at_any_time_while_it_is_out_of_sight(velocity, hit) -> None:
    tracks = follow(clip([turning(hit, LOST, velocity)]), R)  # type: ignore[list-item]
    assert len(rejoined(tracks, R)) == 1


@pytest.mark.parametrize(("wait", "same", "other"), [(0.4, 0.12, 0.17), (2.0, 0.28, 0.34)])
def test_a_stone_comes_back_as_near_to_its_way_as_speeds_and_ice_let_it(wait, same, other) -> None:
    """By 2 cm, 2 cm/s and 0.03 m/s² it may be aside, three and a half times as much at most."""

    def stones(aside: float) -> int:
        def stopped(t: float) -> Place | None:
            return (0.2 + aside, 3.0 - 1.4 - (1.4 - 0.05 * wait) * wait)

        seen = [lambda t: thrown(t), lambda t: stopped(t) if t > LOST + wait + 0.3 else None]
        return len(rejoined(follow(clip(seen, noise=0.0003), R), R))

    assert [stones(aside) for aside in (same, other)] == [1, 2]


def test_the_way_on_which_a_stone_is_lost_is_told_by_what_follows_a_hit() -> None:
    hit, again = LOST - 0.24, LOST + 1.0

    def twice(t: float) -> Place | None:
        here = glide(np.array([0.2, 3.0]), np.array([0.0, -1.5]), min(t, hit))
        if t > hit:
            here = glide(here, np.array([0.9, -0.4]), min(t, again) - hit)
        if t > again:
            here = glide(here, np.array([-0.7, -0.3]), t - again)
        return None if LOST < t < 2.8 else tuple(here)

    assert len(rejoined(follow(clip([twice], noise=0.001), R), R)) == 1


@pytest.mark.parametrize(("back", "stones"), [(3.9, 1), (4.2, 2)])
def test_a_stone_is_waited_for_three_seconds(back, stones) -> None:
    def guard(t: float) -> Place | None:
        x = 0.2 + 1.2 * (t - 3.4)
        return (0.2, 0.4) if t < LOST else (x, 0.4) if t > back else None

    assert len(rejoined(follow(clip([guard], seconds=5.0), R), R)) == stones


def test_a_stone_that_comes_to_rest_does_not_turn_round() -> None:
    places = np.array([(0.1 * t - 0.05 * t**2, 0.0) for t in np.arange(0, 0.21, 0.04)])
    way = _Motion.of(np.arange(0, 0.21, 0.04), [detection(tuple(place)) for place in places])
    assert way.at(np.array([1.0, 2.0, 3.0]))[:, 0] == pytest.approx(0.05, abs=0.01)
    assert way.at(np.array([-1.0]))[0, 0] == pytest.approx(-0.15, abs=0.02)
