"""Rendered pictures against the camera's closed forms."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.synthetic import (
    Paint,
    Sheet,
    Start,
    describe,
    pictures,
    plain_pictures,
    render_still,
    still_camera,
    tilted_camera,
)
from curlshot.tests.helpers.synthetic.render import BARE, CLEAN, lone_stone


def red_centre(picture) -> np.ndarray:
    """Centroid of what is redder than the ice, px."""
    weight = np.clip(picture[..., 2].astype(float) - picture[..., 0], 0, None)
    weight[weight < 12] = 0
    rows, columns = np.indices(weight.shape)
    return np.array([(weight * columns).sum(), (weight * rows).sum()]) / weight.sum()


@pytest.mark.parametrize("place", [(0.0, 0.0), (1.6, 1.2), (-1.9, -1.4)])
def test_cap_stands_at_its_height(place: tuple[float, float]) -> None:
    camera = still_camera(px_per_m=100, target=(0, 0))
    picture = render_still(lone_stone(Start(*place)), camera)
    view = camera.at(0)
    where, on_the_ice = view.project([(*place, 0.12), (*place, 0.0)])
    off = np.hypot(*(red_centre(picture) - where))
    assert off < 0.6  # the handle stands higher and has one thick end
    if place != (0.0, 0.0):
        assert np.hypot(*(red_centre(picture) - on_the_ice)) > 2 * off


def test_blur_is_centred_on_the_frame_s_time() -> None:
    scene = lone_stone(Start(-0.5, -1.0, vx=0.4, vy=2.4))
    camera = still_camera(target=(0, 0))
    sharp = red_centre(render_still(scene, camera, 0.4, shutter=1e-5))
    blurred = red_centre(render_still(scene, camera, 0.4, shutter=0.03))
    assert np.hypot(*(sharp - blurred)) < 0.05


def test_handle_points_along_theta() -> None:
    theta = 0.8
    scene = lone_stone(Start(0.0, 0.0, theta=theta))
    stone = replace(scene.stones[0], handle=(255, 255, 255))
    camera = still_camera(target=(0, 0), px_per_m=300)
    picture = render_still(replace(scene, stones=(stone,)), camera)
    view = camera.at(0)

    def brightness(along: float) -> int:
        x, y = view.project([along * np.cos(theta), along * np.sin(theta), 0.148])
        return int(picture[round(y), round(x)].min())

    assert min(brightness(r) for r in (-0.05, 0.0, 0.04, 0.07)) > 180
    assert brightness(0.095) < 120


@pytest.mark.parametrize("steepness", [0.0, 0.3])
def test_the_free_end_of_a_handle_that_rises_is_seen_at_its_height(steepness: float) -> None:
    """From its middle on it goes up: 0.148 m above the ice there, and so much more at its end."""
    scene = lone_stone(Start(0.0, 0.0, theta=0.0))
    stone = replace(scene.stones[0], handle=(255, 40, 20), steepness=steepness)
    camera = tilted_camera(np.deg2rad(40), px_per_m=400, size=(480, 480))
    picture = render_still(replace(scene, stones=(stone,)), camera, supersample=2)
    middle, end = 0.5 * (0.074 - 0.056), 0.074
    seen = camera.at(0).project([[end - 0.005, 0.0, 0.148 + steepness * (end - 0.005 - middle)]])[0]
    rows, columns = np.nonzero(picture[..., 0] > 100.0 + picture[..., 2])
    beside = np.abs(columns - seen[0]) < 3
    assert rows[beside].mean() == pytest.approx(seen[1], abs=1.0)


def test_truth_of_visibility() -> None:
    scene = lone_stone(Start(0.0, 0.0))
    inside = describe(scene, still_camera(target=(0, 0)), [0.0]).tracks["visible"]
    edge = lone_stone(Start(640 / 110 * (9.9 - 0.12) / 9.9, 0.0))  # the cap's centre on the rim
    half = describe(edge, still_camera(target=(0, 0)), [0.0]).tracks["visible"]
    outside = describe(scene, still_camera(target=(0, 6.0)), [0.0]).tracks["visible"]
    assert (inside[0], outside[0]) == (1.0, 0.0)
    assert 0.3 < half[0] < 0.7


BLACK_ON_WHITE = replace(
    BARE,
    paint=Paint(*((0, 0, 0),) * 4, outline=None, logo=""),
    sheet=Sheet(ice=(255, 255, 255), line=(0, 0, 0), marks=()),
)


@pytest.mark.parametrize("power", [1.0, 2.2])
def test_what_is_half_covered_has_the_code_of_half_its_light(power: float) -> None:
    scene = replace(BLACK_ON_WHITE, light=replace(CLEAN, softness=3.0, power=power))
    camera = still_camera(target=(0, 0), size=(640, 640), px_per_m=150)
    picture = render_still(scene, camera, shutter=1e-4).astype(np.float32)[..., 0]
    angle = np.deg2rad(np.arange(20, 70, 2.0))
    rim = 1.829 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    at = camera.at(0).project(rim).astype(np.float32)
    codes = cv2.remap(picture, at[:, 0].copy(), at[:, 1].copy(), cv2.INTER_LINEAR)
    # Pixels mix codes before that, which counts for a tenth here; half of the codes would be 127.
    assert abs(codes.mean() - 255 * 0.5 ** (1 / power)) < 10


@pytest.mark.parametrize("renderer", [pictures, plain_pictures])
def test_what_is_of_one_colour_has_its_code_however_light_mixes(renderer) -> None:
    paint = Paint(*((60, 60, 60),) * 4, outline=None, logo="")
    scene = replace(BLACK_ON_WHITE, paint=paint, light=replace(CLEAN, power=2.2))
    beside_lines = still_camera(target=(0.6, 0.6), size=(64, 64), px_per_m=100)
    ((_, picture),) = renderer(scene, beside_lines, [0.0], shutter=1e-4)
    assert np.abs(picture.astype(int) - 60).max() <= 1


def test_the_second_renderer_mixes_light() -> None:
    camera = still_camera(target=(0, 0), size=(64, 64), px_per_m=15)
    codes, light = (
        next(
            plain_pictures(
                replace(BLACK_ON_WHITE, light=replace(CLEAN, power=power)), camera, [0.0],
                shutter=1e-4, supersample=4,
            )
        )[1]
        for power in (1.0, 2.2)
    )  # fmt: skip
    share = codes / 255
    mixed = (share > 0.2) & (share < 0.8)
    assert mixed.sum() > 100
    assert np.abs(light - 255 * share ** (1 / 2.2))[mixed].max() < 2
