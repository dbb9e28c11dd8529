from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.synthetic.camera import still_camera
from curlshot.synthetic.scene import Graphic, Person
from curlshot.tests.helpers.vision.stones import (
    BLUE,
    RED,
    YELLOW,
    look,
    scene_of,
)
from curlshot.vision.detection.appearance import colour_difference, learn
from curlshot.vision.detection.stones import plain_disc, search_picture
from curlshot.vision.optics.stick import stick_camera


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
