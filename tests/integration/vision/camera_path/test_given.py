from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

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
from curlshot.tests.helpers.vision.given import SMALL, textured
from curlshot.tests.helpers.vision.places import RINGS
from curlshot.vision.camera_path.given import GivenHouse, fit_given, follow_given
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.reader import open_video

SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])


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
