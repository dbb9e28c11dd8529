from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from curlshot.data.sheet import HOUSE
from curlshot.synthetic import (
    PAINTS,
    CameraPath,
    Scene,
    render_still,
    sample_scene,
    still_camera,
    sweepers,
    tilted_camera,
)
from curlshot.synthetic.scene import Paint
from curlshot.tests.helpers.vision.places import RINGS
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.rig import OVERHEAD
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit

SIZE = (1280, 720)
ANGLE = np.arange(16) * np.pi / 8
OUTLINE = 0.007
"""The library takes the outer side of a painted outline as the edge; the renderer its middle."""


def errors(fit: HouseFit | None, path: CameraPath, height: float = 0.0) -> np.ndarray:
    """Errors, m, of the ring points that are in view."""
    assert fit is not None
    pixels = path.at(1.0).project(np.c_[RINGS, np.full(len(RINGS), height)])
    seen = ((pixels > 0) & (pixels < np.array(fit.camera.size) - 1)).all(1)
    return np.linalg.norm(fit.camera.ice(pixels[seen], height) - RINGS[seen], axis=1)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))


@pytest.mark.parametrize("width", [0.014, 0.04])  # m: 2 px, and as wide as a short profile
@pytest.mark.parametrize("tilt", [0.0, 0.7])
def test_found_by_outlines_alone(tilt: float, width: float) -> None:
    path = tilted_camera(tilt, px_per_m=130.0) if tilt else still_camera(px_per_m=130.0)
    bare = Paint(*[(222, 226, 226)] * 4, outline=(150, 60, 30), outline_width=width)
    fit = find_house(render_still(replace(sample_scene(), paint=bare), path, 1.0))
    assert rms(errors(fit, path)) < 0.0015


def test_found_by_pale_paint() -> None:
    ice, pale = (222, 226, 226), (208, 210, 210)
    paint = Paint(twelve=pale, eight=ice, four=pale, button=ice, outline=None, logo="")
    path = still_camera(px_per_m=130.0)
    fit = find_house(render_still(replace(sample_scene(), paint=paint), path, 1.0))
    assert rms(errors(fit, path)) < 0.004


@pytest.mark.parametrize("name", PAINTS)
def test_found_in_every_colour(name: str) -> None:
    rng = np.random.default_rng(len(name))
    path = still_camera(
        position=(*rng.uniform(-0.4, 0.4, 2), rng.uniform(7.5, 10)),
        target=(rng.uniform(-0.5, 0.5), rng.uniform(-0.8, 1.5)),
        px_per_m=rng.uniform(75, 125),
        roll=rng.uniform(-0.05, 0.05),
        k1=rng.uniform(-0.08, 0.08),
    )
    fit = find_house(render_still(replace(sample_scene(), paint=PAINTS[name]), path, 1.0))
    outlined = 0.0 if PAINTS[name].outline is None else OUTLINE
    assert rms(errors(fit, path)) < 0.002 + outlined
    assert rms(errors(fit, path, 0.12)) < 0.006 + outlined


@pytest.mark.parametrize(("tilt", "bar"), [(15, 0.006), (30, 0.005), (50, 0.01), (60, 0.01)])
def test_found_from_a_tilted_camera(tilt: float, bar: float) -> None:
    path = tilted_camera(np.radians(tilt), roll=0.03, k1=-0.05)
    scene = replace(sample_scene(), paint=PAINTS["navy-orange"])
    fit = find_house(render_still(scene, path, 1.0))
    assert rms(errors(fit, path)) < bar
    if tilt >= 30:
        assert fit is not None and fit.prior is not OVERHEAD
        np.testing.assert_allclose(fit.camera.position, path.position, atol=0.5)


@pytest.mark.parametrize("tilt", [20, 40])
def test_what_is_nearest_may_be_at_the_top(tilt: float) -> None:
    path = tilted_camera(np.radians(tilt), roll=np.pi, px_per_m=130.0, k1=-0.05)
    fit = find_house(render_still(sample_scene(), path, 1.0))
    assert fit is not None
    seen = fit.camera.ice(path.at(1.0).project(np.c_[RINGS, np.zeros(len(RINGS))]))
    np.testing.assert_allclose(np.hypot(*seen.T), np.hypot(*RINGS.T), atol=0.02)
    other_end = np.multiply(path.position, [-1, -1, 1])
    np.testing.assert_allclose(fit.camera.position, other_end, atol=0.5)


@pytest.mark.parametrize("y", [-0.6, 0.6, 2.0])
@pytest.mark.parametrize(("back", "height"), [(4.0, 7.0), (5.8, 9.3), (7.0, 7.0)])
def test_stones_may_come_from_the_top_to_a_camera_above_them(
    back: float, height: float, y: float
) -> None:
    """It hangs on their side of the house: what is nearest is at the top."""
    path = still_camera(position=(0.1, back, height), target=(0.1, y), px_per_m=139.0)
    assert rms(errors(find_house(render_still(sample_scene(), path, 1.0)), path)) < 0.006


@pytest.mark.parametrize(("tilt", "height"), [(63.0, 5.0), (70.0, 5.0), (71.0, 1.6)])
def test_a_camera_beside_the_players_is_refused(tilt: float, height: float) -> None:
    scene = replace(sample_scene(), paint=PAINTS["navy-orange"])
    path = tilted_camera(np.radians(tilt), height=height, px_per_m=150)
    assert (find_house(render_still(scene, path, 1.0)) is None) is (tilt > 66)


@pytest.mark.parametrize("roll", [-0.3, 0.3])
def test_a_tilted_camera_may_lean(roll: float) -> None:
    path = tilted_camera(np.radians(50), roll=roll)
    fit = find_house(render_still(sample_scene(), path, 1.0))
    assert fit is not None
    # Whatever direction is up: the circles are where they should be.
    seen = fit.camera.ice(path.at(1.0).project(np.c_[RINGS, np.zeros(len(RINGS))]))
    np.testing.assert_allclose(np.hypot(*seen.T), np.hypot(*RINGS.T), atol=0.02)


@pytest.mark.parametrize("y", [2.1, 2.6])
def test_part_of_the_house_is_enough(y: float) -> None:
    path = still_camera(target=(0.2, y), px_per_m=130)
    scene = replace(sample_scene(), paint=PAINTS["gold-purple"])
    assert rms(errors(find_house(render_still(scene, path, 1.0)), path)) < 0.01


@pytest.mark.parametrize("tilt", [35, 50])
@pytest.mark.parametrize("target", [(0.0, 1.6), (1.1, 0.9), (-1.2, -0.2), (0.3, -1.0)])
def test_part_of_a_tilted_house_is_enough(target: tuple[float, float], tilt: float) -> None:
    # The 4-ft circle and the button are seen whole, the others are not.
    position = (0.0, -9.0 * float(np.tan(np.radians(tilt))), 9.0)
    path = still_camera(position=position, target=target, px_per_m=310, roll=0.04)
    scene = replace(sample_scene(), paint=PAINTS["navy-orange"])
    assert rms(errors(find_house(render_still(scene, path, 1.0)), path)) < 0.015


def test_people_may_stand_on_the_rings() -> None:
    scene = sample_scene()
    scene = replace(scene, people=sweepers(scene, 2.0), paint=PAINTS["navy-orange"])
    path = still_camera(target=(0.0, 0.5), px_per_m=100, roll=-0.03)
    assert rms(errors(find_house(render_still(scene, path, 1.0)), path)) < 0.004


def test_neighbours_are_not_taken() -> None:
    path = still_camera(position=(0.1, 0.2, 8.0), target=(0.3, 0.5), px_per_m=72)
    scene = Scene(paint=PAINTS["gold-purple"])
    assert rms(errors(find_house(render_still(scene, path, 1.0)), path)) < 0.01


@pytest.mark.parametrize("x", [-0.7, 0.7])
def test_equal_houses_beside_it_are_not_taken(x: float) -> None:
    # The house in the middle is the one with people over it, its neighbours are bare.
    scene = sample_scene()
    near = replace(scene.sheet, pitch=4.7, half_width=(2.2, 2.2))
    scene = replace(scene, sheet=near, people=sweepers(scene, 2.0), paint=PAINTS["navy-orange"])
    path = still_camera(position=(0.1, 0.2, 8.0), target=(x, 0.4), px_per_m=80)
    assert rms(errors(find_house(render_still(scene, path, 1.0)), path)) < 0.01


@pytest.mark.parametrize("side", [-1, 1])
def test_the_house_in_the_middle_is_taken_by_a_camera_aside(side: int) -> None:
    # The houses beside are whole and bare, one of them is larger.
    scene = sample_scene()
    near = replace(scene.sheet, pitch=4.8, half_width=(2.2, 2.2))
    scene = replace(scene, sheet=near, people=sweepers(scene, 2.0))
    path = still_camera(position=(4.9 * side, -9.0, 7.4), target=(0.2, 0.3), px_per_m=60)
    assert rms(errors(find_house(render_still(scene, path, 1.0)), path)) < 0.02


@pytest.mark.parametrize("side", [-1, 1])
def test_the_house_in_the_middle_is_taken_from_beside_the_sheets(side: int) -> None:
    """People stand on it; the one farther off is bare, whole, and above it in the picture."""
    scene = sample_scene()
    near = replace(scene.sheet, pitch=5.0)
    scene = replace(scene, sheet=near, people=sweepers(scene, 2.0))
    path = still_camera(
        position=(5.8 * side, -0.1, 5.4), target=(-0.6 * side, 0.3), px_per_m=75,
        roll=side * np.pi / 2,
    )  # fmt: skip
    fit = find_house(render_still(scene, path, 1.0))
    assert fit is not None
    tee = path.at(1.0).project(np.zeros((1, 3)))
    np.testing.assert_allclose(fit.camera.project(np.zeros((1, 2))), tee, atol=1.0)


def test_no_house_is_no_house() -> None:
    rng = np.random.default_rng(0)
    bare = render_still(sample_scene(), still_camera(target=(0.0, 6.5)), 1.0)
    noise = rng.integers(0, 256, (*SIZE[::-1], 3), dtype=np.uint8)
    blobs = np.full((*SIZE[::-1], 3), 90, np.uint8)
    for _ in range(60):
        centre = (int(rng.integers(SIZE[0])), int(rng.integers(SIZE[1])))
        colour = tuple(int(c) for c in rng.integers(0, 256, 3))
        cv2.circle(blobs, centre, int(rng.integers(10, 160)), colour, -1)
    for image in (bare, noise, blobs, np.full_like(noise, 128)):
        assert find_house(image) is None


WHITE = PAINTS["navy-orange"].eight


@pytest.mark.parametrize(
    "missing",
    [{"four": WHITE, "button": WHITE, "logo": ""}, {"eight": PAINTS["navy-orange"].twelve}],
    ids=["one ring", "12 and 4 ft alone"],
)
def test_few_rings_are_a_house(missing: dict[str, object]) -> None:
    path = still_camera(target=(0.1, 0.3), px_per_m=95, roll=0.02)
    paint = replace(PAINTS["navy-orange"], **missing)
    fit = find_house(render_still(replace(sample_scene(), paint=paint), path, 1.0))
    assert rms(errors(fit, path)) < 0.003


@pytest.mark.parametrize("ratios", [(1, 0.8, 0.6, 0.4, 0.2), (1, 0.9, 0.3), (1, 0.83, 0.67, 0.5)])
def test_a_target_is_no_house(ratios: tuple[float, ...]) -> None:
    rng = np.random.default_rng(4)
    for _ in range(4):
        image = np.full((*SIZE[::-1], 3), rng.integers(0, 256, 3), np.uint8)
        centre, radius = rng.uniform((400, 250), (900, 470)), rng.uniform(120, 300)
        for share in ratios:
            colour = tuple(int(c) for c in rng.integers(0, 256, 3))
            place = tuple(int(v) for v in centre)
            cv2.circle(image, place, round(radius * share), colour, -1, cv2.LINE_AA)
        assert find_house(image) is None


def test_real_stills_agree_with_cameras_measured_by_hand(shared: Path) -> None:
    known = json.loads((shared / "frames/stills.json").read_text())
    radii = (HOUSE.twelve_foot, HOUSE.eight_foot, HOUSE.four_foot)
    places = np.concatenate(
        [r * np.stack([np.cos(ANGLE[::2]), np.sin(ANGLE[::2])], axis=-1) for r in radii]
    )
    every = []
    for still in known["frames"]:
        image = cv2.imread(str(shared / "frames/images" / still["file"]))
        fit = find_house(np.asarray(image, np.uint8))
        assert fit is not None, still["file"]
        hand = Camera(
            0, 0.0, np.array(still["homography"]), tuple(still["size"]), still["k1"], still["k2"]
        )
        error = np.linalg.norm(fit.camera.ice(hand.project(places)) - places, axis=1)
        assert error.max() < 0.02, still["file"]
        every.append(error)
    assert np.median(np.concatenate(every)) < 0.004


@pytest.mark.parametrize("spokes", [0, 5, 7])
def test_a_wheel_is_no_house(spokes: int) -> None:
    image = np.full((720, 1280, 3), 225, np.uint8)
    centre, radius = (600, 350), 300
    for share, colour in ((1.0, (35, 35, 35)), (0.664, (40, 140, 120)), (0.6, (200, 200, 200))):
        cv2.circle(image, centre, round(share * radius), colour, -1, cv2.LINE_AA)
    for angle in 0.2 + 2 * np.pi * np.arange(spokes) / max(spokes, 1):
        end = np.round(centre + 0.6 * radius * np.array([np.cos(angle), np.sin(angle)])).astype(int)
        cv2.line(image, centre, end.tolist(), (110, 60, 60), 14, cv2.LINE_AA)
    assert find_house(image) is None


def test_real_close_ups_are_refused(shared: Path) -> None:
    known = json.loads((shared / "frames/stills.json").read_text())
    for negative in known["negatives"]:
        image = cv2.imread(str(shared / "frames/images" / negative["file"]))
        assert find_house(np.asarray(image, np.uint8)) is None, negative["file"]
