from __future__ import annotations

import pytest

from tests.vision.association.test_follow import RED, YELLOW, Place, R, clip
from vision.association.follow import follow
from vision.association.rejoin import rejoined

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
    assert joined[0].speed == 0.0
