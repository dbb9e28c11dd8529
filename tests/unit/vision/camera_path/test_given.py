from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.synthetic import (
    PAINTS,
    CameraPath,
    broadcast_camera,
    cached_clip,
    render_still,
    sample_scene,
    still_camera,
    tilted_camera,
)
from curlshot.tests.helpers.vision.places import RINGS
from curlshot.vision.camera_path.given import GivenHouse, fit_given, follow_given, hypotheses
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.reader import Video, open_video

SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])
SMALL = (640, 360)


def pointed(
    path: CameraPath, t: float, rng: np.random.Generator, frame: int | None = None
) -> GivenHouse:
    """Where a hand points, 1.5 px in 1000 beside the true places."""
    angle = rng.uniform(-np.pi, np.pi) + np.array([0.0, rng.uniform(0.6, 2.6)])
    ice = np.vstack([np.zeros((1, 2)), 1.829 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)])
    pixels = path.at(t).project(np.c_[ice, np.zeros(3)])
    pixels += rng.normal(0, 0.0015 * path.size[0], pixels.shape)
    return GivenHouse.of(pixels.ravel().tolist(), frame)


def off(camera: Camera, path: CameraPath, t: float) -> np.ndarray:
    return np.asarray(camera.ice(path.at(t).project(np.c_[RINGS, np.zeros(len(RINGS))])) - RINGS)


def textured(folder: Path, shifts: tuple[float, ...]) -> Video:
    """Pictures of the same blots, each moved to the right, without any ring."""
    rng = np.random.default_rng(3)
    wide = rng.integers(0, 256, (SMALL[1] // 8, SMALL[0] // 8 + 10), np.uint8)
    grey = cv2.resize(wide, None, fx=8, fy=8, interpolation=cv2.INTER_CUBIC)
    for k, shift in enumerate(shifts):
        moved = cv2.warpAffine(grey, np.array([[1.0, 0.0, shift], [0.0, 1.0, 0.0]]), SMALL)
        cv2.imwrite(str(folder / f"{k}.png"), cv2.merge([moved] * 3))
    return open_video([folder / f"{k}.png" for k in range(len(shifts))], VideoConfig(fps=25.0))


@pytest.mark.parametrize(
    "path",
    [
        still_camera(position=(0.2, -0.3, 8.0), target=(0.3, 0.6), px_per_m=90, roll=0.04),
        tilted_camera(np.radians(30), roll=-0.03),
        tilted_camera(np.radians(50), roll=0.05, k1=-0.05),
    ],
    ids=["overhead", "30°", "50°"],
)
def test_pointed_at_roughly_it_is_refined_on_the_edges(path: CameraPath) -> None:
    image = render_still(SCENE, path, 1.0)
    fit = fit_given(image, pointed(path, 1.0, np.random.default_rng(2)), frame=7, t=1.0)
    assert fit is not None and fit.camera.frame == 7
    assert np.linalg.norm(off(fit.camera, path, 1.0), axis=1).max() < 0.005


def test_of_two_houses_the_one_pointed_at_is_taken() -> None:
    path = still_camera(position=(0.0, 0.0, 8.0), target=(2.3, 0.3), px_per_m=110)
    image = render_still(SCENE, path, 1.0)
    other = np.array([SCENE.sheet.pitch, 0.0])
    ice = np.vstack([[0.0, 0.0], [-1.829, 0.0], [0.0, 1.829]])
    for place in (np.zeros(2), other):
        pixels = path.at(1.0).project(np.c_[ice + place, np.zeros(3)])
        fit = fit_given(image, GivenHouse.of(pixels.ravel().tolist()))
        assert fit is not None
        expected = np.array([[0.0, 0.0], [-1.829, 0.0], [0.0, 1.829]])
        np.testing.assert_allclose(fit.camera.ice(pixels), expected, atol=0.02)


def test_it_is_followed_from_its_frame_both_ways() -> None:
    path = broadcast_camera(end=1.2, shake=1.5, k1=(-0.06, -0.02), roll=(0.03, -0.03))
    file, truth = cached_clip(SCENE, path, duration=1.2)
    clip = open_video([file])
    t = next(f.t for f in clip if f.index == 12)
    track = follow_given(clip, pointed(path, t, np.random.default_rng(1), 12))
    assert [c.frame for c in track.cameras] == list(range(len(truth.camera)))
    assert max(np.sqrt((off(c, path, c.t) ** 2).sum(1).mean()) for c in track.cameras) < 0.005
    assert not track.warnings


def test_without_edges_the_points_stand_where_the_picture_does(tmp_path: Path) -> None:
    clip = textured(tmp_path, (0.0, 0.4, 20.0, 0.0))
    house = GivenHouse.of((320, 180, 420, 180, 320, 80), 1)
    track = follow_given(clip, house)
    assert [c.frame for c in track.cameras] == [0, 1, 3]
    assert [c.found for c in track.cameras] == [False, True, False]
    for camera in track.cameras:
        points = camera.ice([[320.0, 180.0], [420.0, 180.0], [320.0, 80.0]])
        expected = np.array([[0.0, 0.0], [1.829, 0.0], [0.0, 1.829]])
        np.testing.assert_allclose(points, expected, atol=0.02)
        assert np.isnan(camera.rms_px) and camera.quality == 0
    assert "no rings are seen" in track.warnings[0]
    assert "only the 3 frames" in track.warnings[0]


@pytest.mark.parametrize("points", [(420, 180, 320, 100), (390, 180, 320, 90)])
def test_y_is_up_whichever_way_the_circle_is_foreshortened(
    points: tuple[float, ...], tmp_path: Path
) -> None:
    track = follow_given(textured(tmp_path, (0.0,)), GivenHouse.of((320, 180, *points)))
    tee, ahead = track.cameras[0].project([[0.0, 0.0], [0.0, 0.2]])
    np.testing.assert_allclose(tee, [320, 180], atol=1)
    assert abs(ahead[0] - tee[0]) < 0.5 and ahead[1] < tee[1] - 5


def test_the_points_alone_say_how_far_off_they_may_be(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    clip = textured(tmp_path, (0.0,))
    within = []
    for _ in range(20):
        path = still_camera(
            size=SMALL,
            position=(*rng.uniform(-0.4, 0.4, 2), rng.uniform(7, 10)),
            target=tuple(rng.uniform(-0.6, 0.6, 2)),
            px_per_m=rng.uniform(45, 60),
            roll=rng.uniform(-0.1, 0.1),
        )
        camera = follow_given(clip, pointed(path, 0.0, rng)).cameras[0]
        sd = np.sqrt(np.diagonal(camera.place_cov(RINGS), axis1=1, axis2=2))
        within.append((np.abs(off(camera, path, 0.0)) < 2 * sd).mean())
        assert sd.max() < 0.4
    assert np.mean(within) > 0.93


@pytest.mark.parametrize(
    ("points", "match"),
    [
        ((320, 180, 320, 180, 320, 80), "at least 13 px from the tee"),
        ((320, 180, 325, 180, 320, 80), "at least 13 px from the tee"),
        ((320, 180, 620, 180, 320, 140), "7.5 times as far"),
        ((320, 180, np.nan, 180, 320, 80), "not in a picture of 640 × 360"),
        ((1e9, 180, 420, 180, 320, 80), "not in a picture of 640 × 360"),
    ],
)
def test_points_that_no_house_has_are_refused(points: tuple[float, ...], match: str) -> None:
    with pytest.raises(InputError, match=match):
        hypotheses(GivenHouse.of(points), SMALL)


def test_a_frame_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="frame 9 is not among"):
        follow_given(textured(tmp_path, (0.0,)), GivenHouse.of((320, 180, 420, 180, 320, 80), 9))


def test_a_clip_of_which_nothing_can_be_read_says_so(tmp_path: Path) -> None:
    textured(tmp_path, (0.0,))
    (tmp_path / "1.png").write_bytes(b"no picture")
    clip = open_video(
        [tmp_path / "0.png", tmp_path / "1.png"], VideoConfig(fps=25.0, frames=(1, 1))
    )
    with pytest.raises(InputError, match="none of the frames that are used can be read"):
        follow_given(clip, GivenHouse.of((320, 180, 420, 180, 320, 80)))
