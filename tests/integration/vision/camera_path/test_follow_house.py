from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.stats import norm

from curlshot.data.errors import SceneError
from curlshot.synthetic import (
    PAINTS,
    CameraPath,
    Cut,
    Graphic,
    Key,
    broadcast_camera,
    cached_clip,
    pictures,
    render_still,
    sample_scene,
    still_camera,
    tilted_camera,
)
from curlshot.synthetic.travelling import Travelling
from curlshot.tests.helpers.vision.places import RINGS
from curlshot.vision.camera_path.follow_house import (
    PATIENCE,
    HouseFollower,
    HouseTrack,
    _most_beside,
    follow_house,
)
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.projection import apply_homography
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import image_of
from curlshot.vision.video.reader import open_video

SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])


def rms(camera: Camera, pixels: np.ndarray) -> float:
    """RMS error, m, of the ring points that are in view."""
    seen = ((pixels > 0) & (pixels < np.array(camera.size) - 1)).all(1)
    error = camera.ice(pixels[seen]) - RINGS[seen]
    return float(np.sqrt((error**2).sum(1).mean()))


def follow(
    path: CameraPath, *, duration: float, height: float | None = None, **changes: object
) -> tuple[HouseTrack, int]:
    clip, truth = cached_clip(replace(SCENE, **changes), path, duration=duration)
    return follow_house(open_video([clip]), height=height), len(truth.camera)


def worst(track: HouseTrack, path: CameraPath) -> float:
    ice = np.c_[RINGS, np.zeros(len(RINGS))]
    return max(rms(c, path.at(c.t).project(ice)) for c in track.cameras if c.found)


def test_pan_zoom_roll_and_shake_are_followed() -> None:
    path = broadcast_camera(end=1.2, shake=1.5, k1=(-0.06, -0.02), roll=(0.03, -0.03))
    track, frames = follow(path, duration=1.2)
    assert [c.frame for c in track.cameras] == list(range(frames))
    assert all(c.found for c in track.cameras)
    assert worst(track, path) < 0.005
    assert not track.warnings
    position = track.cameras[0].position
    assert position is not None
    assert abs(position[2] - 9.9) < max(2.5 * track.position_sd[2], 0.3)
    paint = np.array(PAINTS["navy-orange"].radii[:3])
    assert (np.abs(track.radii - paint) < 0.003).all()


def test_of_a_low_camera_overhead_the_height_can_be_said() -> None:
    """Circles seen from straight above are the same from any height; caps above the ice are not."""
    path = still_camera(position=(0.2, 0.4, 5.0), target=(0.2, 0.5), px_per_m=100)
    caps = np.array([(1.6, 0.4, 0.12), (-1.4, 0.2, 0.12), (0.2, 2.0, 0.12)])
    off = []
    for height in (None, 5.1):
        track, _ = follow(path, duration=0.4, height=height)
        camera = track.cameras[-1]
        places = camera.ice(path.at(camera.t).project(caps), height=0.12)
        off.append(float(np.hypot(*(places - caps[:, :2]).T).max()))
        assert worst(track, path) < 0.003
    assert any("give `camera_height`" in w for w in follow(path, duration=0.4)[0].warnings)
    assert not track.warnings
    assert off[0] > 0.008 and off[1] < 0.0025


def test_the_height_of_a_camera_that_hangs_very_low_can_be_said() -> None:
    """A fit that sets out from 8.5 m ended at 3.9 m, 15 mm off, and said it was the view's."""
    path = still_camera(position=(0.2, 0.4, 3.0), target=(0.2, 0.5), px_per_m=100)
    track, frames = follow(path, duration=0.4, height=3.0)
    caps = np.array([(1.6, 0.4, 0.12), (-1.4, 0.2, 0.12), (0.2, 2.0, 0.12)])
    camera = track.cameras[-1]
    places = camera.ice(path.at(camera.t).project(caps), height=0.12)
    assert np.hypot(*(places - caps[:, :2]).T).max() < 0.001
    assert len(track.cameras) == frames and not track.warnings


def test_of_a_height_that_a_slanting_view_belies_nothing_else_is_said() -> None:
    """Its picture is not cropped: an axis aside would make up for the wrong height."""
    path = still_camera(position=(0.3, -4.0, 6.0), target=(0.2, 0.3), px_per_m=100)
    track, _ = follow(path, duration=0.4, height=8.0)
    (text,) = track.warnings
    assert "does not fit this view; the view suggests a lower camera" in text
    assert abs(track.cameras[-1].position[2] - 6.0) < 2 * track.position_sd[2] < 0.02


def test_a_house_that_comes_into_view_late_is_followed_back() -> None:
    keys = (Key(0.0, 0, 5.2, 110), Key(0.3, 0, 5.1, 110), Key(1.6, 0, 1.0, 105))
    path = CameraPath((1280, 720), (-0.1, 0.1, 8.5), keys, 0.2)
    track, frames = follow(path, duration=1.6)
    assert len(track.cameras) > 0.9 * frames
    assert worst(track, path) < 0.006
    found = [c.found for c in track.cameras]
    assert not found[0] and all(found[len(found) // 2 :])
    assert np.isnan(track.cameras[0].rms_px)
    first = track.cameras[found.index(True)]
    assert track.cameras[0].place_sd((0.0, 0.0)) > first.place_sd((0.0, 0.0))
    assert any("tracked by other features of the ice" in w for w in track.warnings)


def test_after_a_cut_back_the_same_camera_goes_on() -> None:
    path = still_camera(target=(0.1, 0.6), px_per_m=100)
    track, frames = follow(path, duration=1.6, cuts=(Cut(0.4, 0.7),))
    assert [c.frame for c in track.cameras] == [*range(10), *range(18, frames)]
    assert worst(track, path) < 0.003
    assert not any("pieces" in w for w in track.warnings)
    assert any("frames 10 to 17; they are left out" in w for w in track.warnings)


def test_frames_that_the_clip_does_not_give_are_not_said_to_show_no_house() -> None:
    clip, truth = cached_clip(SCENE, still_camera(target=(0.1, 0.6), px_per_m=100), duration=0.6)
    follower = HouseFollower((1280, 720))
    for frame in open_video([clip]):
        if frame.index not in (4, 5):
            follower.look(frame)
    track = follower.finish()
    assert track is not None
    assert len(track.cameras) == len(truth.camera) - 2
    assert not track.warnings


@pytest.mark.parametrize("tilt", [0.25, 0.35])
def test_another_camera_is_told_that_has_the_house_at_the_same_place(tilt: float) -> None:
    """Its frames were taken for this one's, with edges that are a pixel off."""
    path = still_camera(target=(0.1, 0.6), px_per_m=100)
    place = (0.0, -8.0 * float(np.tan(tilt)), 8.0)
    other = still_camera(position=place, target=(0.1, 0.6), px_per_m=100)
    track, _ = follow(path, duration=1.6, cuts=(Cut(1.0, 1.6, other),))
    assert [c.frame for c in track.cameras] == [*range(25)]
    assert worst(track, path) < 0.003
    assert any("left out: 2" in w for w in track.warnings)


def test_another_camera_s_house_is_left_out() -> None:
    path = still_camera(target=(0.1, 0.6), px_per_m=100)
    other = tilted_camera(0.7, height=6.0, px_per_m=85)
    track, frames = follow(path, duration=1.6, cuts=(Cut(0.4, 0.8, other),))
    assert [c.frame for c in track.cameras] == [*range(10), *range(20, frames)]
    assert worst(track, path) < 0.003
    assert any("left out: 10 to 19" in w for w in track.warnings)


def test_nothing_wrong_is_fitted_to_a_dissolve() -> None:
    path = still_camera(target=(0.1, 0.6), px_per_m=100)
    track, frames = follow(path, duration=2.0, cuts=(Cut(0.5, 1.3, dissolve=0.2),))
    shown = {c.frame for c in track.cameras}
    assert shown >= {*range(8), *range(frames - 12, frames)}
    assert not shown & set(range(19, 27))
    ice = np.c_[RINGS, np.zeros(len(RINGS))]
    assert max(rms(c, path.at(c.t).project(ice)) for c in track.cameras) < 0.01


def test_a_dissolve_from_another_camera_s_house_ends_its_piece() -> None:
    """The score box stays where it is, as if the camera stood still."""
    path = still_camera(target=(0.1, 0.6), px_per_m=100)
    other = tilted_camera(1.1, height=3.0, px_per_m=110)
    score = Graphic(60, 500, row=60)
    cut = Cut(-1.0, 0.6, other, dissolve=0.3)
    track, frames = follow(path, duration=2.4, cuts=(cut,), graphics=(score,))
    known = [c.frame for c in track.cameras]
    assert 15 < known[0] < 40
    assert known == list(range(known[0], frames))
    assert worst(track, path) < 0.005


def crowd(rng: np.random.Generator, size: tuple[int, int]) -> np.ndarray:
    """A picture full of corners, and without a house."""
    picture = np.full((size[1], size[0], 3), 90, np.uint8)
    for _ in range(300):
        x, y = (int(rng.integers(side)) for side in size)
        colour = rng.integers(0, 256, 3).tolist()
        cv2.rectangle(picture, (x, y), (x + 40, y + 25), colour, -1)
    return picture


@pytest.mark.parametrize("backwards", [False, True])
def test_no_camera_is_carried_onto_what_is_blended_in(tmp_path: Path, backwards: bool) -> None:
    """Nothing moves in either picture, so that what is fixed to the ice seems to go on."""
    house = render_still(SCENE, still_camera())
    other = crowd(np.random.default_rng(3), (house.shape[1], house.shape[0]))
    shown = np.clip(np.arange(45) - 14, 0, 16) / 16
    if backwards:
        shown = shown[::-1]
    paths = []
    for k, share in enumerate(shown.tolist()):
        paths.append(tmp_path / f"{k:02d}.png")
        cv2.imwrite(str(paths[-1]), cv2.addWeighted(other, share, house, 1 - share, 0))
    track = follow_house(open_video(paths))
    frames = [camera.frame for camera in track.cameras]
    assert set(np.flatnonzero(shown == 0).tolist()) <= set(frames)
    assert shown[frames].max() < 0.8


NOISE = np.rint(norm.ppf((np.arange(256) + 0.5) / 256)).astype(np.int8)
"""Noise of one grey level by a random byte, which is far quicker to draw than a normal value."""


def noisy(frames: Iterable[np.ndarray]) -> Iterator[np.ndarray]:
    rng = np.random.default_rng(7)
    for frame in frames:
        drawn = rng.integers(0, 256, frame.shape, dtype=np.uint8)
        yield cv2.add(frame, cv2.LUT(drawn, NOISE), dtype=cv2.CV_8U)


def given_and_kept(
    shown: list[np.ndarray], first: HouseFit | None = None
) -> tuple[list[int], list[int], HouseTrack]:
    """Frames as they are given one by one, those of the track, and the track."""
    size = (shown[0].shape[1], shown[0].shape[0])
    follower = HouseFollower(size, first)
    frames = [Frame(k, k / 25, picture) for k, picture in enumerate(noisy(shown))]
    given = [seen.index for frame in frames for seen, _ in follower.look(frame)]
    given += [seen.index for seen, _ in follower.catch_up()]
    track = follower.finish()
    assert track is not None
    return given, [camera.frame for camera in track.cameras], track


def beside_and_whole() -> tuple[np.ndarray, np.ndarray, np.ndarray, CameraPath]:
    """A house beside that is cut while the one in the middle is hidden, both, and the latter."""
    path = still_camera(target=(0.75, 0.3), px_per_m=115)
    house = render_still(SCENE, path)
    tee, other = (
        path.at(0.0).project(np.array([[x, 0.0, 0.0]]))[0].astype(int).tolist() for x in (0, 5.73)
    )
    hidden, alone = house.copy(), house.copy()
    cv2.circle(hidden, tee, 235, (60, 70, 60), -1)
    cv2.circle(alone, other, 235, (60, 70, 60), -1)
    return hidden, house, alone, path


@pytest.mark.parametrize(
    ("seen", "hidden", "again", "lost"),
    [
        (1, 40, 0, 40),
        (1, 40, 20, 0),
        (20, 50, 20, 0),
        (20, 70, 20, 70),
        (20, 10, 0, 10),
        (20, 10, 20, 0),
    ],
)
def test_rings_may_be_hidden_for_a_while(seen: int, hidden: int, again: int, lost: int) -> None:
    """Corners beside carry the camera; unless the rings come back nothing bears it out."""
    rng = np.random.default_rng(0)
    path = still_camera()
    house = render_still(SCENE, path)
    x, y = path.at(0.0).project(np.zeros((1, 3)))[0].astype(int).tolist()
    reach = 6 + round(abs(path.at(0.0).project(np.array([[1.83, 0.0, 0.0]]))[0, 0] - x))
    for _ in range(80):
        u, v = int(rng.integers(house.shape[1])), int(rng.integers(house.shape[0]))
        if np.hypot(u - x, v - y) > reach + 30:
            cv2.rectangle(house, (u, v), (u + 10, v + 8), rng.integers(0, 256, 3).tolist(), -1)
    covered = house.copy()
    cv2.rectangle(covered, (x - reach, y - reach), (x + reach, y + reach), (60, 70, 60), -1)
    given, kept, track = given_and_kept([house] * seen + [covered] * hidden + [house] * again)
    assert given == kept
    assert len(kept) == seen + hidden + again - lost
    ice = np.c_[RINGS, np.zeros(len(RINGS))]
    pixels = path.at(0.0).project(ice)
    assert max(rms(camera, pixels) for camera in track.cameras) < 0.01


def test_what_was_blended_in_between_two_views_is_left_out() -> None:
    house = render_still(SCENE, still_camera())
    moved = render_still(SCENE, still_camera(target=(0.5, 0.9)))
    other = crowd(np.random.default_rng(3), (house.shape[1], house.shape[0]))
    mixed = [cv2.addWeighted(other, k / 8, house, 1 - k / 8, 0) for k in range(1, 9)]
    given, kept, _ = given_and_kept([house] * 15 + mixed + [other] * 12 + [moved] * 20)
    assert given == kept
    assert {*range(15), *range(35, 55)} <= set(kept)
    assert not set(kept) & set(range(23, 35))


@pytest.mark.parametrize("before", [0, 12])
def test_the_house_in_the_middle_takes_the_place_of_one_beside(before: int) -> None:
    """Also where another camera's house came first."""
    hidden, house, _, path = beside_and_whole()
    other = render_still(SCENE, tilted_camera(0.7, height=6.0, px_per_m=85))
    given, kept, track = given_and_kept([other] * before + [hidden] * 3 + [house] * 24)
    assert given == [*range(before), *kept]
    assert kept[0] >= before
    assert kept[-24:] == list(range(before + 3, before + 27))
    ice = np.c_[RINGS, np.zeros(len(RINGS))]
    assert max(rms(camera, path.at(0.0).project(ice)) for camera in track.cameras) < 0.005


@pytest.mark.parametrize(("wide", "low", "high"), [(20.0, 1.0, 1.0), (11.0, 0.2, 0.8), (4, 0, 0)])
def test_how_much_of_a_house_beside_a_view_may_show(wide: float, low: float, high: float) -> None:
    """From above, so many metres of ice across."""
    scale = 1280 / wide
    down = np.array([[scale, 0.0, 640.0], [0.0, -scale, 360.0], [0.0, 0.0, 1.0]])
    assert low <= _most_beside(Camera(0, 0.0, down, (1280, 720))) <= high


def test_a_house_that_is_asked_for_stays_though_a_fuller_one_stands_beside() -> None:
    hidden, house, _, _ = beside_and_whole()
    first = find_house(hidden)
    assert first is not None
    given, kept, track = given_and_kept([house] * 24, first)
    assert given == kept == list(range(24))
    tee = track.cameras[-1].project(np.zeros((1, 2)))
    assert np.abs(tee - first.camera.project(np.zeros((1, 2)))).max() < 1.0


@pytest.mark.parametrize("count", [6, 7, 9])
def test_each_frame_is_given_once_where_a_house_beside_vanishes(count: int) -> None:
    hidden, _, alone, path = beside_and_whole()
    given, kept, track = given_and_kept([hidden] * count + [alone] * 24)
    assert given == sorted(set(given))
    assert kept == list(range(count, count + 24))
    ice = np.c_[RINGS, np.zeros(len(RINGS))]
    assert max(rms(camera, path.at(0.0).project(ice)) for camera in track.cameras) < 0.005


def test_a_house_is_followed_while_the_picture_fades_in() -> None:
    path = broadcast_camera(end=1.0, size=(640, 360), px_per_m=(64.0, 56.0))
    follower, times = HouseFollower((640, 360)), np.arange(36) / 30
    bright = (picture for _, picture in pictures(SCENE, path, times))
    fading = map(np.multiply, np.linspace(0.03, 1.0, 36), bright)
    for k, (t, image) in enumerate(zip(times.tolist(), noisy(fading), strict=True)):
        follower.look(Frame(k, t, image))
    track = follower.finish()
    assert track is not None
    assert sum(c.found for c in track.cameras) > 30
    assert worst(track, path) < 0.005
    assert not any("pieces" in warning for warning in track.warnings)


def test_jumps_of_the_picture_are_followed() -> None:
    places = ((0.0, 0.5), (0.5, 0.3), (-0.3, 0.9), (0.4, 1.1), (0.0, -0.2), (0.2, 0.8))
    keys = [Key(0.16 * k + dt, x, y, 100) for k, (x, y) in enumerate(places) for dt in (0, 0.12)]
    path = CameraPath((1280, 720), (-0.1, 0.1, 8.5), tuple(keys), 0.2)
    track, frames = follow(path, duration=0.96)
    assert [c.frame for c in track.cameras] == list(range(frames))
    assert all(c.found for c in track.cameras)
    # Where it starts or stops within an exposure, the middle of the blur is not that of the time.
    assert worst(track, path) < 0.008
    still = tuple(c for c in track.cameras if c.frame % 4 in (1, 2))
    assert worst(replace(track, cameras=still), path) < 0.0015


def test_after_a_blow_the_same_camera_goes_on() -> None:
    """Before, it shows half of the house only: its place is hardly known."""
    before, after = (0.2, 2.6, 115, 0.1), (-0.6, 0.3, 115, -0.03)
    keys = [Key(t, *k) for t, k in ((0.0, before), (0.59, before), (0.6, after), (1.6, after))]
    path = CameraPath((1280, 720), (-0.1, 0.1, 8.5), tuple(keys), 0.2)
    track, frames = follow(path, duration=1.6)
    assert [c.frame for c in track.cameras] == list(range(frames))
    assert worst(track, path) < 0.008
    assert not any("pieces" in w for w in track.warnings)


def test_what_is_fixed_to_the_ice_carries_the_camera() -> None:
    keys = (Key(0.0, 0, 1.2, 110), Key(0.6, 0.1, 5.2, 110), Key(3.0, 0, 5.4, 110))
    path = CameraPath((1280, 720), (-0.1, 0.1, 8.5), keys, 0.2)
    track, frames = follow(path, duration=3.0, graphics=(Graphic(60, 40, row=30),))
    assert [c.frame for c in track.cameras] == list(range(frames))
    assert not any(c.found for c in track.cameras[20:])
    grid = np.stack(np.meshgrid([-1.2, 0.0, 1.2], [3.4, 4.4, 5.4]), axis=-1).reshape(-1, 2)
    ratio, off = [], []
    for c in track.cameras[20:]:
        pixels = path.at(c.t).project(np.c_[grid, np.zeros(len(grid))])
        seen = ((pixels > 0) & (pixels < np.array(c.size) - 1)).all(1)
        error = c.ice(pixels[seen]) - grid[seen]
        off.append(np.linalg.norm(error, axis=1).max())
        stated = np.diagonal(c.place_cov(grid[seen]), axis1=-2, axis2=-1)
        ratio.append((error / np.sqrt(stated)).ravel())
    # A frame or two of a clip may be centimetres off: with other noise one of six has such.
    assert np.quantile(off, 0.95) < 0.008 and max(off) < 0.06
    # All frames share one error, that of the keyframe: it is one draw.
    assert (np.abs(np.concatenate(ratio)) < 3).mean() > 0.95


def test_a_slowly_moving_camera_is_followed() -> None:
    start = tilted_camera(0.6, height=7.0, px_per_m=100)
    path = Travelling(**vars(start), velocity=(0.3, 0.0, -0.1))
    track, frames = follow(path, duration=1.2)
    assert [c.frame for c in track.cameras] == list(range(frames))
    assert worst(track, path) < 0.004
    for c in (track.cameras[0], track.cameras[-1]):
        assert c.position is not None
        np.testing.assert_allclose(c.position, path.at(c.t).position, atol=0.06)


def test_a_camera_that_stays_has_one_place() -> None:
    track, _ = follow(broadcast_camera(start=0.0, end=1.0), duration=1.2)
    places = np.array([c.position for c in track.cameras])
    assert np.ptp(places, axis=0).max() == 0.0


def test_one_pass_gives_each_frame_once_and_in_order() -> None:
    keys = (Key(0.0, 0, 5.2, 110), Key(0.3, 0, 5.1, 110), Key(1.6, 0, 1.0, 105))
    path = CameraPath((1280, 720), (-0.1, 0.1, 8.5), keys, 0.2)
    file, truth = cached_clip(SCENE, path, duration=1.6)
    clip = open_video([file])
    follower = HouseFollower(clip.size)
    placed = [(f, c) for frame in clip for f, c in follower.look(frame)]
    placed += follower.catch_up()
    assert [f.index for f, _ in placed] == list(range(len(truth.camera)))
    assert all(f.index == c.frame and f.t == c.t for f, c in placed)
    assert max(rms(c, path.at(c.t).project(np.c_[RINGS, np.zeros(len(RINGS))]))
               for _, c in placed if c.found) < 0.02  # fmt: skip
    track = follower.finish()
    assert track is not None
    assert [c.frame for c in track.cameras] == [c.frame for _, c in placed]
    assert HouseFollower(clip.size).finish() is None


@pytest.mark.parametrize("after", [0, PATIENCE + 2])
def test_frames_too_few_to_fit_what_they_share_are_given_as_well(after: int) -> None:
    file, _ = cached_clip(SCENE, broadcast_camera(start=0.0, end=1.0), duration=1.2)
    clip = open_video([file])
    frames = list(islice(clip, 4))
    bare = np.full_like(image_of(frames[0].picture), 230)
    follower = HouseFollower(clip.size)
    placed = [*map(follower.look, frames)]
    assert not any(placed)
    placed += [follower.look(Frame(4 + k, (4 + k) / 25, bare)) for k in range(after)]
    if not after:
        placed.append(follower.catch_up())
    given = [(frame.index, camera.frame) for some in placed for frame, camera in some]
    assert given == [(k, k) for k in range(4)]


def test_a_single_picture_is_a_clip(tmp_path: Path) -> None:
    path = still_camera(target=(0.1, 0.4), px_per_m=105)
    picture = tmp_path / "still.png"
    cv2.imwrite(str(picture), render_still(SCENE, path, 1.0))
    track = follow_house(open_video([picture]))
    assert len(track.cameras) == 1
    assert rms(track.cameras[0], path.at(1.0).project(np.c_[RINGS, np.zeros(len(RINGS))])) < 0.003


def test_a_clip_without_a_house_says_what_to_do() -> None:
    with pytest.raises(SceneError, match=r"no house in view.*`stick`"):
        follow(still_camera(target=(0.0, 6.5)), duration=0.4)


def test_real_ice_under_a_known_camera(shared: Path) -> None:
    base = shared / "clips/semireal_pyeongchang_two_hits"
    truth = json.loads(base.with_suffix(".truth.json").read_text())
    track = follow_house(open_video([base.with_suffix(".mp4")]))
    assert len(track.cameras) == len(truth["frames"])
    errors = []
    for camera in track.cameras:
        matrix = np.array(truth["frames"][camera.frame]["homography"])
        errors.append(rms(camera, apply_homography(matrix, RINGS)))
    assert np.median(errors) < 0.004 and max(errors) < 0.01
    first = truth["frames"][0]
    place = -np.array(first["R"]).T @ np.array(first["T"])
    np.testing.assert_allclose(track.cameras[0].position, place, atol=0.5)


@pytest.mark.parametrize("start", [4.6, 3.9])
def test_a_camera_that_leans_is_found_though_it_comes_to_the_house_from_afar(start: float) -> None:
    """A sliver of the house looks as if seen from overhead, or leaning to the other side."""
    keys = (Key(0.0, 0.1, start, 100), Key(1.4, 0.1, 1.3, 100), Key(2.0, 0.1, 1.2, 100))
    path = CameraPath((960, 540), (0.3, 3.0, 9.0), keys)
    track, frames = follow(path, duration=2.0)
    assert len(track.cameras) == frames
    position = track.cameras[0].position
    assert position is not None
    assert np.abs(position - path.position).max() < 0.2
    assert worst(track, path) < 0.005


def test_without_sides_a_camera_that_leans_is_found_by_all_of_the_house() -> None:
    """By later frames or in the end; without both it was 23 cm off."""
    sheet = replace(SCENE.sheet, border=SCENE.sheet.ice, carpet=SCENE.sheet.ice, pitch=50.0)
    keys = (Key(0.0, 0.1, 4.6, 66), Key(1.2, 0.1, 1.3, 66), Key(2.0, 0.1, 1.2, 66))
    path = CameraPath((640, 360), (0.3, 3.0, 9.0), keys)
    track, _ = follow(path, duration=1.6, sheet=sheet)
    position = track.cameras[0].position
    assert position is not None
    assert np.abs(position - path.position).max() < 0.3
    assert worst(track, path) < 0.01
