from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.config import VideoConfig
from curlshot.data.measurement import Duplicate
from curlshot.synthetic.video import write_video
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.reader import Video, open_video
from curlshot.vision.video.telecine import Telecine

Image = NDArray[np.uint8]


def scene(n: int, noise: float = 0.0, pace: float = 3.0) -> list[Image]:
    """A disc that goes to the right over what is printed on the ice, by a camera that stands."""
    rng = np.random.default_rng(5)
    ice = cv2.GaussianBlur(rng.integers(90, 250, (180, 320, 3)).astype(np.uint8), (0, 0), 3)
    out = []
    for k in range(n):
        image = ice.copy()
        at = (round(16 * (20 + pace * k)), 16 * 90)
        cv2.circle(image, at, 16 * 14, (30, 30, 200), -1, cv2.LINE_AA, 4)
        grain = rng.normal(0, noise, image.shape) if noise else 0.0
        out.append(np.clip(image + grain, 0, 255).astype(np.uint8))
    return out


def film(path: Path, pictures: Sequence[Image], fps: float) -> Video:
    write_video(path, [(k / fps, picture) for k, picture in enumerate(pictures)], fps=fps)
    return open_video([path])


def left(clip: Video) -> list[int]:
    given = [frame.index for frame in clip]
    assert sorted([*given, *clip.duplicates]) == list(range(clip.decoded))
    return sorted(clip.duplicates)


@pytest.mark.parametrize("noise", [0.0, 3.0])
def test_of_pictures_told_twice_the_second_is_left_out(tmp_path: Path, noise: float) -> None:
    twice = [picture for picture in scene(30, noise) for _ in (0, 1)]
    clip = film(tmp_path / "a.mp4", twice, 50.0)
    assert left(clip) == [*range(1, 60, 2)]
    assert clip.duplicates[31] == (pytest.approx(0.62), 30)
    assert "frames repeat the one before" in clip.warnings[0]


def test_a_picture_that_stands_still_while_time_goes_on_is_told_once(tmp_path: Path) -> None:
    moving = scene(50, 2.0)
    halted = [*moving[:20], *[moving[20]] * 16, *moving[36:]]
    assert left(film(tmp_path / "a.mp4", halted, 25.0)) == [*range(21, 36)]


@pytest.mark.parametrize("noise", [0.0, 3.0])
@pytest.mark.parametrize("pace", [0.0, 0.1, 3.0])
def test_pictures_of_their_own_stay(tmp_path: Path, noise: float, pace: float) -> None:
    assert left(film(tmp_path / "a.mp4", scene(50, noise, pace), 25.0)) == []


@pytest.mark.parametrize("noise", [0.0, 3.0])
def test_a_recording_that_halts_at_its_end_has_no_measurement_there(
    tmp_path: Path, noise: float
) -> None:
    moving = scene(30, noise)
    assert left(film(tmp_path / "a.mp4", [*moving, *[moving[-1]] * 6], 25.0)) == [*range(30, 36)]
    part = open_video([tmp_path / "a.mp4"], VideoConfig(frames=(5, 32)))
    assert [frame.index for frame in part] == [*range(5, 30)]
    assert part.duplicates[32] == (pytest.approx(1.28), 29)


def test_a_scene_that_slows_down_and_rests_is_measured_to_its_end(tmp_path: Path) -> None:
    """Without any noise its last frames are equal, but the last motion was small."""
    times = np.minimum(np.arange(50) / 40, 1.0)
    ice = scene(1)[0]
    slowing = []
    for at in 20 + 120 * times - 60 * times**2:
        image = ice.copy()
        cv2.circle(image, (round(16 * at), 16 * 90), 16 * 14, (30, 30, 200), -1, cv2.LINE_AA, 4)
        slowing.append(image)
    assert left(film(tmp_path / "a.mp4", slowing, 25.0)) == []


def test_a_scene_without_noise_that_comes_to_rest_stays(tmp_path: Path) -> None:
    moving = scene(40)
    assert left(film(tmp_path / "a.mp4", [*moving, *[moving[-1]] * 60], 25.0)) == []
    assert left(film(tmp_path / "b.mp4", [*[moving[0]] * 40, *moving], 25.0)) == []


def test_single_repeats_stay_for_they_say_how_unsure_times_are(tmp_path: Path) -> None:
    pictures = scene(40, 2.0)
    again = (3, 7, 9, 15, 17, 20, 26, 31, 33, 36)
    some = sorted([*range(40), *again])
    # Of a first repeat nothing says yet that it is alone.
    assert left(film(tmp_path / "a.mp4", [pictures[k] for k in some], 30.0)) in ([], [1])


def test_pictures_from_files_are_told_as_well(tmp_path: Path) -> None:
    paths = [tmp_path / f"{k:03}.png" for k in range(40)]
    for k, path in enumerate(paths):
        cv2.imwrite(str(path), scene(20, 2.0)[k // 2])
    assert left(open_video(paths, VideoConfig(fps=50.0))) == [*range(1, 40, 2)]


def still(folder: Path) -> Video:
    """A clip of one picture."""
    cv2.imwrite(str(folder / "still.png"), scene(1)[0])
    return open_video([folder / "still.png"])


def test_a_repeat_has_the_camera_of_what_it_shows_as_one_that_was_carried(tmp_path: Path) -> None:
    matrix = np.diag([100.0, -100.0, 1.0])
    cameras = [Camera(k, 0.04 * k, matrix + k, (320, 180)) for k in (0, 2)]
    clip = still(tmp_path)
    clip.duplicates = {1: Duplicate(0.03, 0), 5: Duplicate(0.2, 4)}
    after = clip.finish(cameras)
    assert [(c.frame, c.t, c.found) for c in after] == [
        (0, 0, True),
        (1, 0.03, False),
        (2, 0.08, True),
    ]
    clip.duplicates = {4: Duplicate(0.16, 3), 3: Duplicate(0.12, 2)}
    assert [c.frame for c in clip.finish(cameras)] == [0, 2, 3, 4]
    assert np.array_equal(after[1].homography, cameras[0].homography)


def test_cameras_get_the_times_at_which_frames_were_taken(tmp_path: Path) -> None:
    """A frame that the first pass took for new repeats another: it has no camera of its own."""
    matrix = np.diag([100.0, -100.0, 1.0])
    cameras = [Camera(k, 0.04 * k, matrix + k, (320, 180)) for k in (0, 2, 3)]
    clip = still(tmp_path)
    assert clip.retime(cameras) == tuple(cameras)
    clip.duplicates = {2: Duplicate(0.08, 0)}
    clip.telecine = Telecine(20.0, 25.0, {0: -0.01, 1: 0.04, 3: 0.13}, clip.duplicates)
    assert [(c.frame, c.t) for c in clip.retime(cameras)] == [(0, -0.01), (3, 0.13)]
    finished = clip.finish(cameras)
    assert [(c.frame, c.t) for c in finished] == [(0, -0.01), (2, 0.08), (3, 0.13)]
    assert np.array_equal(finished[1].homography, cameras[0].homography)
    assert np.array_equal(finished[2].homography, cameras[2].homography)
