from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.camera import still_camera, tilted_camera
from curlshot.synthetic.clip import render_still
from curlshot.synthetic.scene import Colour, Graphic, Person
from curlshot.synthetic.scenes import PAINTS
from curlshot.tests.helpers.vision.stones import (
    BLUE,
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    look,
    misses,
    scene_of,
    without_colours,
)
from curlshot.vision.detection.appearance import BY_SHAPE, colour_difference, convincing, learn
from curlshot.vision.detection.stones import FOLLOWING, SEARCH, Search, plain_disc, search_picture
from curlshot.vision.optics.camera import Camera, CameraError
from curlshot.vision.optics.stick import stick_camera
from curlshot.vision.video.reader import open_video


@pytest.mark.parametrize("paint", ["teal-red", "navy-orange", "red-white", "grey-red"])
def test_stones_are_found_on_rings_of_any_colour_also_of_their_own(paint: str) -> None:
    places = [(0.3, 0.2, RED), (-0.35, 0.3, YELLOW), (1.4, 0.6, RED), (-1.2, -0.9, YELLOW)]
    places += [(0.1, 2.7, RED), (-0.6, 1.4, RED), (0.95, -0.2, YELLOW)]
    scene = scene_of(places, paint=PAINTS[paint], graphics=(Graphic(),))
    found = look(scene)
    assert len(found) == len(places)
    assert misses(found, scene).max() < 0.010
    assert all(s.visible > 0.8 for s in found)


def test_touching_stones_are_two() -> None:
    apart = 2 * STONE.radius + 0.0005
    scene = scene_of([(0.2, 0.9, RED), (0.2 + apart, 0.9, RED), (0.2, 0.9 + apart, YELLOW)])
    found = look(scene)
    assert len(found) == 3
    assert misses(found, scene).max() < 0.010


@pytest.mark.parametrize("caps", [(RED, RED), (BLUE, YELLOW)])
def test_errors_are_within_what_is_claimed(caps: tuple[Colour, Colour]) -> None:
    rng = np.random.default_rng(5)
    places = [(x, y, caps[int(rng.integers(2))]) for x in (-1.3, 0.1, 1.2) for y in (-1, 0.9, 2.2)]
    scene = scene_of(places)
    found = look(scene)
    error = misses(found, scene)
    assert len(found) == len(places)
    claimed = np.median([np.hypot(np.hypot(s.sd_x, s.sd_y), np.hypot(*s.sd_place)) for s in found])
    assert np.sqrt((error**2).mean()) < 2 * claimed
    assert claimed < 0.006


def test_a_camera_whose_height_is_not_known_misplaces_caps_more_than_the_ice() -> None:
    # Height and focal length that grow together leave what lies on the ice where it is.
    scene, plumb = scene_of([(1.6, 1.0, RED)]), (0.1, 0.6)
    path = still_camera(position=(*plumb, 8.0), target=plumb, px_per_m=140.0)
    camera, z, sd = camera_of(path, scene), 8.0, 0.5
    unknown = np.array([0, 0, 0, sd / z, 0, 0, sd, 0, 0])
    none = np.zeros((9, 9))
    errors = CameraError(none, none), CameraError(np.outer(unknown, unknown), none)
    image = np.asarray(render_still(scene, path), np.uint8)
    known, doubted = (
        search_picture(image, replace(camera, error=error)).stones[0] for error in errors
    )
    off = STONE.cap_height * sd / z**2 * np.hypot(1.6 - plumb[0], 1.0 - plumb[1])
    added = np.sqrt(np.sum(np.square(doubted.sd_place)) - np.sum(np.square(known.sd_place)))
    assert added == pytest.approx(off, rel=0.1)


def test_a_slanting_view_does_not_draw_stones_towards_the_camera() -> None:
    places = [(0.3, 0.2, RED), (-0.45, 0.3, YELLOW), (0.9, 1.0, RED), (-1.0, -0.6, YELLOW)]
    scene = scene_of([*places, (0.1, 1.3, RED), (-0.8, 1.1, RED)])
    path = tilted_camera(np.radians(40))
    seen = look(scene, path)
    assert len(seen) == len(scene.stones)
    true = np.array([(stone.start.x, stone.start.y) for stone in scene.stones])
    found = np.array([(s.x, s.y) for s in seen])
    nearest = np.hypot(*(true[:, None] - found[None]).transpose(2, 0, 1)).argmin(1)
    off = found[nearest] - true
    assert np.abs(off.mean(0)).max() < 0.0015
    assert np.sqrt((off**2).sum(1).mean()) < 0.0025


def test_in_a_picture_without_colours_caps_lighter_or_darker_than_granite_are_found() -> None:
    scene = scene_of([(0.3, 0.2, RED), (-0.35, 0.3, YELLOW), (1.4, 0.6, RED), (0.1, 2.4, YELLOW)])
    found = search_picture(without_colours(scene), camera_of(CAMERA, scene), BY_SHAPE).stones
    assert len(found) == len(scene.stones)
    assert misses(found, scene).max() < 0.010
    person = Person(((0.0, 0.5, 0.2, 1.0),))
    empty = scene_of([], people=(person,), graphics=(Graphic(),))
    assert search_picture(without_colours(empty), camera_of(CAMERA, empty), BY_SHAPE).stones == ()


@pytest.mark.parametrize("y", [-6.2, 6.2])
def test_guards_are_found_whichever_end_of_the_sheet_is_up_in_the_picture(y: float) -> None:
    scene = scene_of([(0.3, y, RED), (-0.7, 0.9 * y, YELLOW)])
    found = look(scene, still_camera(px_per_m=140.0, target=(0.0, 0.9 * y)))
    assert len(found) == 2 and misses(found, scene).max() < 0.01


@pytest.mark.parametrize("search", [SEARCH, FOLLOWING], ids=["one picture", "a clip"])
@pytest.mark.parametrize("inside", [0.02, 0.0])
def test_a_stone_cut_by_the_edge_of_the_picture_is_found_in_its_place(
    inside: float, search: Search
) -> None:
    path = still_camera(px_per_m=140.0, target=(0.0, 0.0))
    bottom = float(camera_of(path, scene_of([])).ice(np.array([640.0, 719.5]), 0.12)[1])
    scene = scene_of([(0.3, bottom + inside, YELLOW), (0.0, 1.0, YELLOW)])
    found = look(scene, path, search)
    assert len(found) == 2
    assert misses(found, scene).max() < 0.015
    assert 0.3 < min(s.visible for s in found) < 0.8


def test_ice_between_letters_is_no_granite() -> None:
    places = [(0.4, 0.2, RED), (-0.5, 0.4, YELLOW), (1.4, 0.6, RED), (-1.2, -0.9, YELLOW)]
    scene, middle = scene_of(places), np.array([[0.1, 2.6]])
    picture, camera = np.array(render_still(scene, CAMERA), np.uint8), camera_of(CAMERA, scene)
    learned = learn(look(scene))
    row, column = np.indices(picture.shape[:2])
    ((u, v),) = camera.project(middle, STONE.cap_height)
    away = np.hypot(column - u, row - v) / camera.scale_at(middle)

    def found(lightness: int) -> int:
        """How many are seen with a letter, others around it, and so light a ring between."""
        drawn = picture.copy()
        drawn[away < 1.5 * STONE.radius] = RED
        drawn[(away > STONE.cap_radius) & (away < STONE.radius)] = lightness
        blurred = cv2.GaussianBlur(drawn, (0, 0), 0.7)
        return len(search_picture(blurred, camera, learned).stones)

    assert found(170) == len(places) + 1  # a stone in bright light
    assert found(205) == found(220) == len(places)


def test_real_stills(shared: Path) -> None:
    import json

    stills = json.loads((shared / "frames" / "stills.json").read_text())["frames"]
    errors: list[float] = []
    false = 0
    for still in stills[::3]:
        picture = next(iter(open_video([shared / "frames" / "images" / still["file"]])))
        size = (still["size"][0], still["size"][1])
        place = np.array(still["camera"]["xyz"])
        matrix = np.array(still["homography"])
        camera = Camera(0, 0.0, matrix, size, still["k1"], still["k2"], position=place)
        found = search_picture(picture.image, camera).stones
        found = search_picture(picture.image, camera, learn(convincing(found))).stones
        true = np.array([(s["x"], s["y"]) for s in still["stones"]])
        apart = np.hypot(
            *(true[:, None] - np.array([(s.x, s.y) for s in found])[None]).transpose(2, 0, 1)
        )
        errors += apart.min(1).tolist()
        false += int((apart.min(0) > 0.15).sum())
    assert np.median(errors) < 0.006
    assert np.percentile(errors, 95) < 0.025
    assert false <= 4  # some stones are not in the list of those measured


def test_people_logos_and_empty_ice_are_no_stones() -> None:
    person = Person(((0.0, 0.5, 0.2, 1.0),))
    assert look(scene_of([], people=(person,), graphics=(Graphic(),))) == ()


def test_stones_of_the_neighbouring_sheet_are_left_out() -> None:
    scene = scene_of([(0.0, 1.0, RED), (3.2, 1.0, RED), (-3.0, 0.2, YELLOW)])
    found = look(scene, still_camera(px_per_m=90.0))
    assert [(round(s.x, 1), round(s.y, 1)) for s in found] == [(0.0, 1.0)]


def test_learned_colours_are_those_of_the_caps() -> None:
    found = look(scene_of([(0.5, 0.8, RED), (-0.9, 0.3, BLUE), (0.2, 2.0, RED)]))
    learned = learn(found)
    assert learned is not None
    assert len(learned.caps) == 2
    seen = [np.array(cap.bgr, float) for cap in learned.caps]
    for colour in (RED, BLUE):
        assert min(np.abs(s - colour).max() for s in seen) < 60
    assert learn([]) is None
    assert colour_difference(learned.caps[0].mean, learned.caps[1].mean) > 60


def test_discs_of_which_only_the_radius_is_known() -> None:
    image = np.full((240, 320, 3), 25, np.uint8)
    true = [(80.3, 60.7), (114.6, 60.7), (250.2, 180.4)]
    fine = 16
    for (x, y), colour in zip(true, [(200, 120, 60), (60, 70, 160), (15, 15, 90)], strict=True):
        centre = (round(x * fine), round(y * fine))
        cv2.circle(image, centre, 17 * fine, colour, -1, cv2.LINE_AA, 4)
    cv2.rectangle(image, (150, 20), (200, 54), (180, 180, 180), -1)
    # A ring of their size is none of them, and one about a disc takes nothing from it.
    for ring in ((60, 190), (115, 61)):
        cv2.circle(image, ring, 16 if ring[0] == 60 else 27, (230, 230, 80), 3, cv2.LINE_AA)
    camera = stick_camera((0, 239, 100, 239, 0.5), (320, 240))
    found = search_picture(image, camera, None, plain_disc(0.085)).stones
    assert len(found) == 3
    pixels = camera.project(np.array([(s.x, s.y) for s in found]))
    apart = np.hypot(*(pixels[:, None] - np.array(true)[None]).transpose(2, 0, 1)).min(0)
    assert apart.max() < 0.25


@pytest.mark.parametrize("ground", [25, 200])
@pytest.mark.parametrize("inside", [9.0, 25.0])
def test_rings_are_no_discs_beside_the_picture_s_edge_either(ground: int, inside: float) -> None:
    camera = stick_camera((0, 239, 100, 239, 0.5), (320, 240))

    def found(thickness: int) -> int:
        image = np.full((240, 320, 3), ground, np.uint8)
        image += (0.2 * np.arange(320)).astype(np.uint8)[None, ::-1, None] // 2  # light falls off
        image[120:123, :20] = 120  # a line that ends within it
        centre = (round(inside * 16), 120 * 16)
        radius = 17 * 16 if thickness < 0 else 16 * 16
        cv2.circle(image, centre, radius, (60, 70, 160), thickness, cv2.LINE_AA, 4)
        return len(search_picture(image, camera, None, plain_disc(0.085)).stones)

    assert found(3) == 0
    assert found(-1) == 1


def test_a_disc_half_on_paint_of_its_colour_is_one() -> None:
    image = np.full((240, 320, 3), 200, np.uint8)
    image[:, :160] = (60, 70, 160)
    cv2.circle(image, (160 * 16 + 6, 120 * 16), 17 * 16, (60, 70, 160), -1, cv2.LINE_AA, 4)
    cv2.circle(image, (160 * 16 + 6, 120 * 16), 16 * 16, (20, 20, 20), 3, cv2.LINE_AA, 4)
    camera = stick_camera((0, 239, 100, 239, 0.5), (320, 240))
    assert len(search_picture(image, camera, None, plain_disc(0.085)).stones) == 1
