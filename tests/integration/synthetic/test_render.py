"""Rendered pictures against the camera's closed forms."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.synthetic import (
    CameraPath,
    Paint,
    Start,
    broadcast_camera,
    pictures,
    plain_pictures,
    random_scene,
    render_still,
    still_camera,
    tilted_camera,
)
from curlshot.tests.helpers.synthetic.render import BARE, lone_stone


def edge_errors(picture, view, radius: float) -> np.ndarray:
    """Distance in px, along the normal, from where the circle should be to where it is."""
    angles = np.deg2rad(np.arange(5, 360, 7.0))
    angles = angles[np.abs(np.sin(2 * angles)) > 0.5]  # clear of tee, centre and back line
    errors = []
    for a in angles:
        out = np.array([np.cos(a), np.sin(a), 0.0])
        along = np.array([-np.sin(a), np.cos(a), 0.0])
        where, beside = view.project([radius * out, radius * out + 1e-4 * along])
        normal = np.array([beside[1] - where[1], where[0] - beside[0]])
        normal /= np.linalg.norm(normal)
        s = np.arange(-4, 4.01, 0.05)
        points = (where + s[:, None] * normal).astype(np.float32)
        w, h = view.lens.size
        if not ((points > 2) & (points < [w - 3, h - 3])).all():
            continue
        line = cv2.remap(
            picture.astype(np.float32).sum(-1), points[:, 0].copy(), points[:, 1].copy(),
            cv2.INTER_LINEAR,
        ).ravel()  # fmt: skip
        level = (line - line[0]) / (line[-1] - line[0])
        errors.append(np.trapezoid(1 - level, s) - 4)
    assert len(errors) > 10
    return np.array(errors)


@pytest.mark.parametrize(
    ("camera", "t", "supersample"),
    [
        (still_camera(), 0.0, 1),
        (broadcast_camera(k1=(-0.1, 0.0), k2=(0.03, 0.0), shake=1.0), 0.5, 1),
        (broadcast_camera(px_per_m=(150, 100)), 6.0, 1),  # zoomed out: coarser plates
        (broadcast_camera(px_per_m=(150, 70)), 6.0, 1),
        (tilted_camera(np.deg2rad(45), size=(960, 540), px_per_m=75, k1=-0.05), 0.0, 2),
    ],
)
def test_ring_edges_lie_where_the_camera_says(
    camera: CameraPath, t: float, supersample: int
) -> None:
    picture = render_still(BARE, camera, t, supersample=supersample, shutter=1e-4)
    for radius in BARE.paint.radii[:3]:
        errors = edge_errors(picture, camera.at(t), radius)
        assert abs(errors.mean()) < 0.02
        assert np.sqrt((errors**2).mean()) < 0.05


@pytest.mark.parametrize(
    ("camera", "supersample"),
    [(broadcast_camera(size=(640, 360), px_per_m=(55, 55), k1=(-0.1, -0.1)), 2),
     (tilted_camera(np.deg2rad(45), size=(640, 360), px_per_m=50), 3)],
)  # fmt: skip
def test_the_second_renderer_sees_the_same_rings(camera: CameraPath, supersample: int) -> None:
    ((_, picture),) = plain_pictures(BARE, camera, [0.5], shutter=1e-4, supersample=supersample)
    for radius in BARE.paint.radii[:3]:
        errors = edge_errors(picture, camera.at(0.5), radius)
        assert abs(errors.mean()) < 0.02
        assert np.sqrt((errors**2).mean()) < 0.1


@pytest.mark.parametrize("renderer", [pictures, plain_pictures])
def test_an_outlined_ring_ends_at_its_radius(renderer) -> None:
    camera = still_camera(px_per_m=300, target=(1.3, 1.3), size=(480, 480))
    dark = Paint(*(BARE.sheet.ice,) * 4, outline=(20, 20, 20), outline_width=0.02, logo="")
    scene = replace(BARE, paint=dark, sheet=replace(BARE.sheet, line=BARE.sheet.ice))
    ((_, picture),) = renderer(scene, camera, [0.0], shutter=1e-4)
    angle = np.linspace(0.75, 0.85, 40)
    way = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    for radius, inside in ((1.827, True), (1.811, True), (1.831, False), (1.807, False)):
        x, y = np.round(camera.at(0).project(radius * way)).astype(int).T
        assert (np.median(picture[y, x, 0]) < 130) == inside


def test_the_picture_is_a_function_of_the_scene() -> None:
    scene = random_scene(np.random.default_rng(3))
    first, second = (render_still(scene, broadcast_camera(), 1.0) for _ in range(2))
    assert np.array_equal(first, second)


@pytest.mark.parametrize("t", [0.5, 6.0])
def test_lines_lie_where_the_camera_says(t: float) -> None:
    dark = replace(BARE, sheet=replace(BARE.sheet, line=(20, 20, 20)))
    camera = broadcast_camera(roll=(0.2, 0.2), k1=(-0.05, -0.05), px_per_m=(150, 100))
    picture = render_still(dark, camera, t, shutter=1e-4).astype(np.float32).sum(-1)
    view = camera.at(t)
    steps = np.linspace(0.8, 1.15, 15)[:, None]
    s = np.arange(-6, 6.01, 0.05)
    for along in np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]):
        errors = []
        for where, further in zip(
            view.project(steps * along), view.project((steps + 1e-3) * along), strict=True
        ):
            normal = np.array([where[1] - further[1], further[0] - where[0]])
            normal /= np.linalg.norm(normal)
            points = (where + s[:, None] * normal).astype(np.float32)
            line = cv2.remap(
                picture, points[:, 0].copy(), points[:, 1].copy(), cv2.INTER_LINEAR
            ).ravel()
            weight = np.clip(np.median(line) - line, 0, None)
            weight[weight < 20] = 0
            errors.append((weight * s).sum() / weight.sum())
        assert abs(np.mean(errors)) < 0.03


@pytest.mark.parametrize("renderer", [pictures, plain_pictures])
def test_the_side_of_a_cap_shows_aslant_alone(renderer) -> None:
    scene = lone_stone(Start(0.0, 0.0))
    bare = scene.stones[0]
    walled = replace(scene, stones=(replace(bare, wall=0.02),))
    aslant = tilted_camera(np.deg2rad(45), size=(320, 320), px_per_m=400)
    towards = aslant.position[:2] / np.hypot(*aslant.position[:2])
    on_side = [*(0.99 * bare.cap_radius * towards), bare.cap_height - 0.5 * 0.02]
    x, y = np.round(aslant.at(0).project(on_side)).astype(int)
    redness = []
    for each in (scene, walled):
        ((_, picture),) = renderer(each, aslant, [0.0], shutter=1e-4)
        redness.append(int(picture[y, x, 2]) - int(picture[y, x, 0]))
    assert redness[0] < 30
    assert redness[1] > 60
    plumb = still_camera(target=(0, 0), size=(320, 320), px_per_m=300, position=(0, 0, 9))
    ((_, without),), ((_, with_side),) = (
        renderer(each, plumb, [0.0], shutter=1e-4) for each in (scene, walled)
    )
    assert np.abs(without.astype(int) - with_side).max() <= 2
