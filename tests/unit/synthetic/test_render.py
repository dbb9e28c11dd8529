"""Rendered pictures against the camera's closed forms."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.synthetic import (
    CameraPath,
    Light,
    Paint,
    Scene,
    Sheet,
    Start,
    broadcast_camera,
    describe,
    pictures,
    plain_pictures,
    random_scene,
    red_stone,
    render_still,
    still_camera,
    tilted_camera,
)

CLEAN = Light(glare=0, vignette=0, softness=0, noise=0, texture=0)
BARE = Scene(paint=Paint(outline=None, logo=""), sheet=Sheet(marks=()), light=CLEAN)


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


def red_centre(picture) -> np.ndarray:
    """Centroid of what is redder than the ice, px."""
    weight = np.clip(picture[..., 2].astype(float) - picture[..., 0], 0, None)
    weight[weight < 12] = 0
    rows, columns = np.indices(weight.shape)
    return np.array([(weight * columns).sum(), (weight * rows).sum()]) / weight.sum()


def lone_stone(start: Start) -> Scene:
    stone = replace(red_stone("A", start), handle=(44, 26, 178))
    sheet = Sheet(marks=(), line=BARE.sheet.ice)
    plain = Paint(*(BARE.sheet.ice,) * 4, outline=None, logo="")
    return replace(BARE, stones=(stone,), paint=plain, sheet=sheet, light=replace(CLEAN, lamps=()))


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


def test_the_picture_is_a_function_of_the_scene() -> None:
    scene = random_scene(np.random.default_rng(3))
    first, second = (render_still(scene, broadcast_camera(), 1.0) for _ in range(2))
    assert np.array_equal(first, second)


def test_truth_of_visibility() -> None:
    scene = lone_stone(Start(0.0, 0.0))
    inside = describe(scene, still_camera(target=(0, 0)), [0.0]).tracks["visible"]
    edge = lone_stone(Start(640 / 110 * (9.9 - 0.12) / 9.9, 0.0))  # the cap's centre on the rim
    half = describe(edge, still_camera(target=(0, 0)), [0.0]).tracks["visible"]
    outside = describe(scene, still_camera(target=(0, 6.0)), [0.0]).tracks["visible"]
    assert (inside[0], outside[0]) == (1.0, 0.0)
    assert 0.3 < half[0] < 0.7


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
