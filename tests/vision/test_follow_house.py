from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from data.errors import SceneError
from tests.synthetic import (
    PAINTS,
    CameraPath,
    Cut,
    Key,
    broadcast_camera,
    cached_clip,
    render_still,
    sample_scene,
    still_camera,
)
from vision.camera import Camera, apply_homography
from vision.clip import open_clip
from vision.follow_house import HouseTrack, follow_house

ANGLE = np.arange(16) * np.pi / 8
RINGS = np.concatenate(
    [r * np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=-1) for r in (1.829, 1.219, 0.61)]
)
SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])


def rms(camera: Camera, pixels: np.ndarray) -> float:
    """RMS error, m, of the ring points that are in view."""
    seen = ((pixels > 0) & (pixels < np.array(camera.size) - 1)).all(1)
    error = camera.ice(pixels[seen]) - RINGS[seen]
    return float(np.sqrt((error**2).sum(1).mean()))


def follow(path: CameraPath, *, duration: float, **changes: object) -> tuple[HouseTrack, int]:
    clip, truth = cached_clip(replace(SCENE, **changes), path, duration=duration)
    return follow_house(open_clip([clip])), len(truth.camera)


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


def test_a_house_that_comes_into_view_late_is_followed_back() -> None:
    keys = (Key(0.0, 0, 4.6, 110), Key(0.6, 0, 3.5, 110), Key(1.6, 0, 1.0, 105))
    path = CameraPath((1280, 720), (-0.1, 0.1, 8.5), keys, 0.2)
    track, frames = follow(path, duration=1.6)
    assert len(track.cameras) > 0.9 * frames
    assert worst(track, path) < 0.006
    found = [c.found for c in track.cameras]
    assert not found[0] and all(found[len(found) // 2 :])
    assert np.isnan(track.cameras[0].rms_px)
    first = track.cameras[found.index(True)]
    assert track.cameras[0].place_sd((0.0, 0.0)) > first.place_sd((0.0, 0.0))
    assert any("carried" in w for w in track.warnings)


def test_after_a_cut_the_longest_piece_is_used() -> None:
    path = still_camera(target=(0.1, 0.6), px_per_m=100)
    track, frames = follow(path, duration=1.6, cuts=(Cut(0.4, 0.7),))
    shown = [c.frame for c in track.cameras]
    assert min(shown) >= 16
    assert max(shown) == frames - 1
    assert worst(track, path) < 0.003
    assert any("separate pieces" in w for w in track.warnings)


def test_a_single_picture_is_a_clip(tmp_path: Path) -> None:
    path = still_camera(target=(0.1, 0.4), px_per_m=105)
    picture = tmp_path / "still.png"
    cv2.imwrite(str(picture), render_still(SCENE, path, 1.0))
    track = follow_house(open_clip([picture]))
    assert len(track.cameras) == 1
    assert rms(track.cameras[0], path.at(1.0).project(np.c_[RINGS, np.zeros(len(RINGS))])) < 0.003


def test_a_clip_without_a_house_says_what_to_do() -> None:
    with pytest.raises(SceneError, match=r"no house in view.*--stick"):
        follow(still_camera(target=(0.0, 6.5)), duration=0.4)


def test_real_ice_under_a_known_camera(shared: Path) -> None:
    base = shared / "clips/semireal_pyeongchang_two_hits"
    truth = json.loads(base.with_suffix(".truth.json").read_text())
    track = follow_house(open_clip([base.with_suffix(".mp4")]))
    assert len(track.cameras) == len(truth["frames"])
    errors = []
    for camera in track.cameras:
        matrix = np.array(truth["frames"][camera.frame]["homography"])
        errors.append(rms(camera, apply_homography(matrix, RINGS)))
    assert np.median(errors) < 0.004 and max(errors) < 0.01
    first = truth["frames"][0]
    place = -np.array(first["R"]).T @ np.array(first["T"])
    np.testing.assert_allclose(track.cameras[0].position, place, atol=0.5)
