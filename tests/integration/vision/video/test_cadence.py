"""Pictures taken at one rate and told at another; which is shown when is counted out by hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import ceil
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.synthetic.video import write_video
from curlshot.vision.video.reader import Video, open_video
from curlshot.vision.video.telecine import Shown, find_telecine

Image = NDArray[np.uint8]
TOLD = 30.0


def scene(pace: Sequence[float], grain: float) -> Iterator[Image]:
    """A disc that goes so many pixels from each picture to the next, over what is on the ice."""
    rng = np.random.default_rng(3)
    ice = cv2.GaussianBlur(rng.integers(90, 250, (120, 480, 3)).astype(np.uint8), (0, 0), 3)
    for at in 20 + np.cumsum(pace):
        image = ice.copy()
        cv2.circle(image, (round(16 * at), 16 * 60), 16 * 12, (30, 30, 200), -1, cv2.LINE_AA, 4)
        noisy = image + rng.normal(0, grain, image.shape)
        yield np.clip(noisy, 0, 255).astype(np.uint8)


def told(
    path: Path,
    shown: Sequence[int],
    pace: float | Sequence[float] = 2.5,
    *,
    grain: float = 2.0,
    late: float | NDArray[np.float64] = 0.0,
) -> Video:
    """Write a clip whose frames show these pictures."""
    times = np.arange(len(shown)) / TOLD + late
    pictures = [*scene(np.broadcast_to(pace, max(shown) + 1).tolist(), grain)]
    frames = [(float(t), pictures[which]) for t, which in zip(times, shown, strict=True)]
    write_video(path, frames, fps=TOLD)
    return open_video([path])


def pulled_down(rate: Fraction, pictures: int, begin: Fraction = Fraction(0)) -> list[int]:
    """Say which picture each frame shows, if so many are taken per frame: the latest by then."""
    first = [ceil((n + begin) / rate) for n in range(pictures + 1)]
    return [n for n in range(pictures) for _ in range(first[n + 1] - first[n])]


def firsts(shown: Sequence[int]) -> list[int]:
    return [k for k, which in enumerate(shown) if which not in shown[:k]]


def read_twice(clip: Video) -> tuple[list[int], list[float]]:
    """Frames and times of a second pass; the first shows the cadence."""
    assert clip.telecine is None
    for _ in clip:
        pass
    frames = [(frame.index, frame.t) for frame in clip]
    return [index for index, _ in frames], [t for _, t in frames]


@pytest.mark.parametrize(
    ("rate", "pictures"),
    [
        (Fraction(24, 30), 60),
        (Fraction(24000, 30030), 60),
        (Fraction(25, 30), 60),
        (Fraction(20, 30), 60),
        (Fraction(15, 25), 60),
        (Fraction(24, 60), 60),
        (Fraction(25, 60), 60),
        (Fraction(24, 25), 150),
    ],
    ids=str,
)
def test_pictures_have_the_times_at_which_they_were_taken(
    tmp_path: Path, rate: Fraction, pictures: int
) -> None:
    shown = pulled_down(rate, pictures, Fraction(2, 7))
    clip = told(tmp_path / "a.mp4", shown, 400 / pictures)
    frames, times = read_twice(clip)
    assert frames == firsts(shown)
    true = np.array([shown[k] for k in frames]) / (float(rate) * TOLD)
    off = np.array(times) - true
    # What all are late by no one can tell; 24 of 25 for 24000 of 30030 is off by a thousandth.
    np.testing.assert_allclose(off, off.mean(), atol=0.06 / TOLD)
    told_at = np.array(frames) / TOLD
    assert np.abs(times[1:] - told_at[1:]).max() < 0.5 / TOLD
    assert sorted([*frames, *clip.duplicates]) == [*range(len(shown))]
    for frame, (t, of) in clip.duplicates.items():
        assert of == firsts(shown)[shown[frame] - shown[0]]
        assert t == pytest.approx(frame / TOLD, abs=1e-3)


def test_it_is_said_what_was_done(tmp_path: Path) -> None:
    clip = told(tmp_path / "a.mp4", pulled_down(Fraction(24, 30), 60))
    read_twice(clip)
    (said,) = clip.warnings
    assert "15 of 75 frames repeat the one before" in said
    assert "converted from 24 to 30 frames a second" in said
    assert "even times are restored" in said


def test_a_first_pass_gives_frames_as_they_are_told(tmp_path: Path) -> None:
    clip = told(tmp_path / "a.mp4", pulled_down(Fraction(24, 30), 60))
    given = [(frame.index, frame.t * TOLD) for frame in clip]
    np.testing.assert_allclose(*zip(*given, strict=True), atol=1e-3)
    # Of a first repeat nothing says yet that it is alone.
    assert clip.read == len(given) in (74, 75)
    assert (clip.decoded, len(clip.duplicates)) == (75, 15)


def test_a_cadence_goes_on_while_nothing_moves(tmp_path: Path) -> None:
    shown = pulled_down(Fraction(24, 30), 100)
    pace = np.where(np.arange(100) // 35 == 1, 0.0, 3.0)
    frames, times = read_twice(told(tmp_path / "a.mp4", shown, [*pace], grain=0.0))
    assert frames == firsts(shown)
    np.testing.assert_allclose(np.diff(times), 1 / 24, rtol=5e-3)


def test_a_cadence_stays_where_the_recording_halts(tmp_path: Path) -> None:
    shown = pulled_down(Fraction(24, 30), 80)
    halted = [shown[40] if 40 < k < 50 else which for k, which in enumerate(shown)]
    frames, times = read_twice(told(tmp_path / "a.mp4", halted))
    assert frames == firsts(halted)
    np.testing.assert_allclose(np.diff(times)[:30], 1 / 24, rtol=5e-3)


def as_told(clip: Video, kept: Sequence[int] | None = None) -> bool:
    """Whether a second pass gives frames at the times at which they are told."""
    frames, times = read_twice(clip)
    np.testing.assert_allclose(np.array(times) * TOLD, frames, atol=1e-3)
    return clip.telecine is None and (kept is None or frames == [*kept])


def test_repeats_that_come_by_chance_leave_times_as_they_are(tmp_path: Path) -> None:
    chance = np.random.default_rng(11)
    for share in (0.1, 0.3):
        shown = np.cumsum(np.append(0, chance.random(89) > share))
        assert as_told(told(tmp_path / f"{share}.mp4", shown.tolist()))


@pytest.mark.parametrize("each", [3, 5, 10])
def test_pictures_that_are_lost_and_the_one_before_told_instead_come_in_no_cadence(
    tmp_path: Path, each: int
) -> None:
    shown = [k - (k % each == each - 1) for k in range(90)]
    assert as_told(told(tmp_path / "a.mp4", shown))


def test_repeats_that_grain_hides_make_no_find_telecine_the_others(tmp_path: Path) -> None:
    shown = pulled_down(Fraction(24, 30), 80)
    clip = told(tmp_path / "a.mp4", shown, grain=8.0)
    frames, _ = read_twice(clip)
    assert clip.telecine is not None
    assert frames == firsts(shown)


def test_repeats_among_which_nothing_is_surely_new_have_no_cadence() -> None:
    seen = [None, False] * 4 + [None]
    assert find_telecine([Shown(k, k / 50, new, 1.0) for k, new in enumerate(seen)]) is None


@pytest.mark.parametrize(("pause", "one"), [(0.0, True), (3600.0, False), (95_000.0, False)])
def test_no_cadence_goes_on_across_a_pause(pause: float, one: bool) -> None:
    shown = pulled_down(Fraction(24, 30), 60)
    times = np.arange(len(shown)) / TOLD + pause * (np.arange(len(shown)) > 40)
    new = np.diff(shown, prepend=-1) > 0
    frames = [
        Shown(k, t, bool(n), float(n)) for k, (t, n) in enumerate(zip(times, new, strict=True))
    ]
    assert (find_telecine(frames) is not None) == one


def test_pictures_that_are_all_told_twice_are_told_evenly(tmp_path: Path) -> None:
    shown = [k // 2 for k in range(90)]
    assert as_told(told(tmp_path / "a.mp4", shown), [*range(0, 90, 2)])


@pytest.mark.parametrize("grain", [0.0, 3.0])
@pytest.mark.parametrize("pace", [0.0, 0.1, 3.0])
def test_pictures_of_their_own_have_no_cadence(tmp_path: Path, pace: float, grain: float) -> None:
    shown = [*range(90)]
    assert as_told(told(tmp_path / "a.mp4", shown, pace, grain=grain), shown)


def test_times_that_vary_are_those_of_the_container(tmp_path: Path) -> None:
    shown = pulled_down(Fraction(24, 30), 60)
    late = np.random.default_rng(2).uniform(0, 0.9 / TOLD, len(shown))
    late[0] = 0.0
    clip = told(tmp_path / "a.mp4", shown, late=late)
    frames, times = read_twice(clip)
    assert clip.telecine is None
    np.testing.assert_allclose(times, np.array(frames) / TOLD + late[frames], atol=1e-4)


def test_three_repeats_are_too_few(tmp_path: Path) -> None:
    shown = pulled_down(Fraction(24, 30), 12)
    assert as_told(told(tmp_path / "a.mp4", shown))
