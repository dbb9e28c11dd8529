from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.synthetic import render_still, tilted_camera
from curlshot.tests.helpers.vision.proof import (
    BLUE,
    HOUSE,
    ICE,
    RED,
    SCENE,
    SIZE,
    drawn,
    level,
    proved,
    seen,
)
from curlshot.vision.optics.pose import View, project
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
from curlshot.vision.sheet.marks import measure_marks
from curlshot.vision.sheet.proof import is_house, stands_alone, worth
from curlshot.vision.video.picture import Image


@pytest.fixture(scope="module")
def low() -> tuple[Image, HouseFit]:
    """A house from so near that circles about it run behind the camera."""
    camera = tilted_camera(np.deg2rad(50), height=3.4, px_per_m=110)
    picture = np.asarray(render_still(SCENE, camera, 0.0), np.uint8)
    found = find_house(picture)
    assert found is not None
    assert np.hypot(*found.rig[:2]) < 5.0
    return picture, found


def test_a_house_is_one_though_its_surroundings_reach_behind_the_camera(
    low: tuple[Image, HouseFit],
) -> None:
    picture, found = low
    assert worth(found.evidence) > 1.5
    assert is_house(picture, found.evidence, found.view, found.rig)


@pytest.mark.parametrize(
    ("paint", "darker", "alone"),
    [(None, 16, True), (None, 30, False), (32, 8, True), (32, 17, False)],
)
def test_a_circle_about_a_house_stands_out_by_what_its_rings_do(
    paint: int | None, darker: int, alone: bool
) -> None:
    """Of rings in strong colours, and of some that are hardly darker than the ice."""
    bleak, faint = ((b - by, g - by, r - by) for by in (paint or 0, darker) for b, g, r in [ICE])
    house = HOUSE if paint is None else ((1.829, bleak), HOUSE[1], (0.619, bleak))
    picture = drawn(((2.5, faint), *house))
    assert stands_alone(picture, seen(picture), *level()) is alone


@pytest.mark.parametrize("cross", [True, False])
def test_bare_ice_between_the_paint_or_the_lines_prove_it(cross: bool) -> None:
    assert proved(drawn(HOUSE, cross=cross))
    painted = ((1.829, BLUE), (1.2135, (60, 160, 60)), (0.619, RED))
    assert proved(drawn(painted, cross=cross)) == cross


def test_a_circle_more_than_a_house_has_makes_a_target(low: tuple[Image, HouseFit]) -> None:
    picture, found = low
    angle = np.linspace(0, 2 * np.pi, 200)
    ring = 1.5 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    size = (picture.shape[1], picture.shape[0])
    line = project(ring, found.view.vector, found.rig, size)
    target = picture.copy()
    cv2.polylines(target, [np.round(line).astype(np.int32)], True, (30, 200, 230), 6)
    assert not is_house(target, found.evidence, found.view, found.rig)
    assert not stands_alone(target, found.evidence, found.view, found.rig)
    assert stands_alone(picture, found.evidence, found.view, found.rig)


def test_corners_that_a_lens_leaves_dark_are_no_circle() -> None:
    scale, border = 170.0, 2.2
    picture = np.full((SIZE[1], SIZE[0], 3), ICE, np.uint8)
    for radius, colour in HOUSE:
        cv2.circle(picture, (480, 270), round(scale * radius), colour, -1, cv2.LINE_AA)
    x, y = np.meshgrid(np.arange(SIZE[0]) - 480, np.arange(SIZE[1]) - 270)
    picture[np.abs(x) > scale * border] = (90, 50, 30)
    light = 1 - 0.8 * (x**2 + y**2) / (480**2 + 270**2)
    dark = np.asarray(picture * light[..., None], np.uint8)
    view, rig = View(np.array([0.0, 0.0, 0.0, np.log(scale * 9)])), level()[1]
    evidence = measure_marks(dark, view.vector, rig, reach=6.0)
    assert stands_alone(dark, evidence, view, rig)


def test_a_house_is_worth_most() -> None:
    whole, few, none = (worth(seen(drawn(rings))) for rings in (HOUSE, HOUSE[::2], ()))
    assert 3.0 < whole <= 3.5
    assert 0 < few < whole
    assert none == 0


def test_two_circles_of_which_none_is_the_second_need_ice_around_them() -> None:
    assert worth(seen(drawn(HOUSE[::2]))) > 0
    assert worth(seen(drawn(HOUSE[::2], ground=(60, 60, 60)))) == 0
    assert worth(seen(drawn(HOUSE[:1]))) == 0


def test_two_circles_of_which_none_is_the_second_are_none_of_a_sliver() -> None:
    """Of a sliver of the house the 8-ft circle looks like the 4-ft one of a nearer house."""
    evidence = seen(drawn(HOUSE[::2]))
    assert worth(evidence) > 0
    assert worth(replace(evidence, visible=0.42 * evidence.visible)) == 0
    whole = seen(drawn(HOUSE))
    assert worth(replace(whole, visible=0.42 * whole.visible)) > 0


@pytest.mark.parametrize("radius", [0.9, 1.5, 2.5])
def test_a_circle_where_a_house_has_none_disproves_it(radius: float) -> None:
    more = sorted((*HOUSE, (radius, (90, 140, 60))), reverse=True)
    assert not proved(drawn(tuple(more)))


@pytest.mark.parametrize("rings", [False, True])
def test_the_4_ft_circle_is_not_taken_for_the_12_ft_one(rings: bool) -> None:
    """Nor where less than half of the circles around it, three times as large, is in view."""
    larger = tuple((3 * radius, colour) for radius, colour in HOUSE[:2]) if rings else ()
    image = drawn((*larger, (1.829, RED), (0.619, ICE)))[70:-70]
    assert proved(image) is not rings


@pytest.mark.parametrize(("tall", "wide"), [(540, 960), (400, 560)])
def test_without_an_8_ft_circle_what_is_around_must_be_in_view(tall: int, wide: int) -> None:
    image = drawn((HOUSE[0], HOUSE[2]))
    rows, columns = (SIZE[1] - tall) // 2, (SIZE[0] - wide) // 2
    image = image[rows : SIZE[1] - rows, columns : SIZE[0] - columns]
    assert worth(seen(image)) > 0
    assert proved(image) is (wide == SIZE[0])
