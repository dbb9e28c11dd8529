from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from curlshot.tests.helpers.vision.tracks import Place, R, detection
from curlshot.vision.association.follow import Track
from curlshot.vision.association.strays import without_strays

FPS = 25.0


def track(
    path: Callable[[float], Place],
    faint: Callable[[float], bool],
    until: float,
    *,
    noise: float = 0.001,
    shown: float = 0.32,
) -> Track:
    """Build one track, whose evidence is a third of the usual while it is faint."""
    rng = np.random.default_rng(5)
    out = Track()
    for frame in range(round(until * FPS)):
        t = frame / FPS
        x, y = np.array(path(t)) + rng.normal(0, noise, 2)
        out.add(frame, t, detection((x, y), score=2.8 * shown if faint(t) else 2.8), R)
    return out


def resting(t: float) -> Place:
    return (1.0, 2.0)


def pulled(begin: float, end: float, course: Callable[[float], Place]) -> Callable[[float], Place]:
    """A shoulder of its colour comes over a stone, or leaves it, at 1.4 m/s."""

    def path(t: float) -> Place:
        x, y = course(t)
        return (x, y + 0.1 + 1.4 * (t - begin)) if begin <= t < end else (x, y)

    return path


def gliding(t: float) -> Place:
    return (0.5 * t - 0.03 * t**2, 1.0)


@pytest.mark.parametrize("course", [resting, gliding])
@pytest.mark.parametrize(("begin", "end"), [(0.0, 0.3), (0.8, 1.1), (1.7, 2.0)])
def test_what_takes_a_track_along_is_left_out(course, begin: float, end: float) -> None:
    whole = track(pulled(begin, end, course), lambda t: begin <= t < end, 2.0)
    bystander = track(lambda t: (0.8, 0.3), lambda t: False, 2.0)
    left, same = without_strays([whole, bystander], R)
    assert same is bystander
    out = [t for t in whole.times if t not in left.times]
    assert out == [t for t in whole.times if begin <= t < end]
    assert len(left.detections) == len(left.times) == len(left.frames)
    assert [one.score for one in left.detections] == [2.8] * len(left.times)


def test_a_stone_half_covered_where_it_rests_or_glides_stays() -> None:
    for course in (resting, gliding):
        for begin, end in ((0.0, 0.5), (0.8, 1.3), (1.5, 2.0)):
            whole = track(course, lambda t, b=begin, e=end: b <= t < e, 2.0)
            assert without_strays([whole], R) == [whole]


@pytest.mark.parametrize("shown", [0.6, 1.0])
def test_what_is_seen_by_more_than_half_stays_wherever_it_goes(shown: float) -> None:
    whole = track(pulled(1.0, 1.3, resting), lambda t: 1.0 <= t < 1.3, 2.0, shown=shown)
    assert without_strays([whole], R) == [whole]


def test_the_course_of_a_stone_is_told_by_what_follows_a_hit_and_by_places_millimetres_off() -> (
    None
):
    def path(t: float) -> Place:
        here = (0.0, 2.0 - 2.0 * t) if t < 0.5 else (1.5 * (t - 0.5), 1.0)
        return (here[0], here[1] + 0.1 + 1.4 * (t - 1.0)) if 1.0 <= t < 1.3 else here

    whole = track(path, lambda t: 1.0 <= t < 1.3, 1.3, noise=0.0025)
    (left,) = without_strays([whole], R)
    assert left.times == [t for t in whole.times if t < 1.0]


def test_a_faint_stone_that_was_hit_goes_where_it_was_sent() -> None:
    def struck(t: float) -> Place:
        return (1.0 + 1.2 * max(t - 1.0, 0.0), 2.0)

    def thrown(t: float) -> Place:
        return (1.0 - 2 * R - 1.3 * max(1.0 - t, 0.0), 2.0)

    both = [track(struck, lambda t: t > 0.9, 1.4), track(thrown, lambda t: False, 1.4)]
    assert without_strays(both, R) == both
    assert len(without_strays(both[:1], R)[0].times) < 30  # by nothing that was seen


def test_a_stone_that_slows_down_in_the_dark_stays() -> None:
    """By frost or shadow, eight times as much as on clean ice."""

    def slowed(t: float) -> Place:
        s = 0.6 * t - (0.4 * (t - 0.8) ** 2 if t > 0.8 else 0.0)
        return (0.0, 2.5 - s)

    whole = track(slowed, lambda t: t > 0.9, 1.5)
    assert without_strays([whole], R) == [whole]


def test_a_stone_may_have_been_faster_before_it_was_clear() -> None:
    def slowed(t: float) -> Place:
        """Till 0.5 s, by 1.4 m/s²."""
        dark = min(t, 0.5)
        return (0.0, 2.5 - 0.5 * t - 1.4 * dark * (0.5 - 0.5 * dark))

    whole = track(slowed, lambda t: t < 0.5, 1.5)
    assert without_strays([whole], R) == [whole]


@pytest.mark.parametrize(
    ("before", "hit", "after", "aside"), [(2.0, 0.4, 0.0, 1.5), (1.0, 0.5, 1.0, 0.5)]
)
def test_a_hit_just_before_a_stone_fades_says_nothing_against_it(before, hit, after, aside) -> None:
    """A thrown stone enters faintly; soon after it is clear it is hit aside."""

    def path(t: float) -> Place:
        since = max(t - hit, 0.0)
        return (aside * since, 2.0 - before * min(t, hit) - after * since)

    whole = track(path, lambda t: t < 0.3, 1.5)
    assert without_strays([whole], R) == [whole]


def test_a_faint_stone_that_is_clear_on_its_new_course_stays() -> None:
    def struck(t: float) -> Place:
        return (1.0 + 1.2 * max(t - 1.0, 0.0), 2.0)

    whole = track(struck, lambda t: 0.8 < t < 1.2, 2.0)
    assert without_strays([whole], R) == [whole]


@pytest.mark.parametrize(("at_once", "speed"), [(0.025, 0.0), (0.0, 0.12)])
def test_what_covers_a_stone_may_draw_it_aside(at_once: float, speed: float) -> None:
    def drawn(t: float) -> Place:
        return (1.0, 2.0 + at_once + speed * (t - 1.5) if t > 1.5 else 2.0)

    whole = track(drawn, lambda t: t > 1.5, 2.1)
    assert without_strays([whole], R) == [whole]
