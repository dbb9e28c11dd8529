"""Wide lenses, as fixed cameras of clubs have them: the hog line tells them, at either end."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.synthetic import PAINTS, CameraPath, Key, render_still, sample_scene
from curlshot.vision.optics.rig import HOG_Y, K1, OVERHEAD, POSITION
from curlshot.vision.sheet.house import find_house

Picture = NDArray[np.uint8]

SCENE = replace(sample_scene(), paint=PAINTS["navy-orange"])
GUARDS = np.array([(x, y) for x in (-1.0, 0.0, 1.0) for y in (2.5, 4.0, 5.5)])


def club(k1: float, k2: float, y: float = -0.3, z: float = 6.0) -> CameraPath:
    """A camera that stands, pictures upright, and shows the ice up to the hog line."""
    return CameraPath((440, 770), (0.03, y, z), (Key(0.0, 0.05, 1.7, 100.0, k1=k1, k2=k2),))


def fill(
    image: Picture,
    path: CameraPath,
    x: tuple[float, float],
    y: tuple[float, float],
    grey: int = 20,
) -> None:
    """Fill a rectangle on the ice, dark if not otherwise said."""
    corners = path.at(0.0).project([(x[k], y[m], 0.0) for k, m in ((0, 0), (1, 0), (1, 1), (0, 1))])
    cv2.fillConvexPoly(image, np.round(corners).astype(np.int32), (grey, grey, grey))


def guards_off(
    path: CameraPath, *, turned: bool, covered: tuple[tuple[float, float], ...] = ()
) -> tuple[float, float]:
    """How far off guards would be, m, and where the hog line was seen, y, m."""
    image = np.array(render_still(SCENE, path), np.uint8)
    for left, right in covered:
        fill(image, path, (left, right), (5.7, 6.9))
    pixels, ice = path.at(0.0).project(np.c_[GUARDS, np.zeros(len(GUARDS))]), GUARDS
    if turned:
        image, pixels, ice = np.rot90(image, 2), np.array(path.size) - 1 - pixels, -GUARDS
    house = find_house(np.ascontiguousarray(image))
    assert house is not None
    off = np.linalg.norm(house.camera.ice(pixels) - ice, axis=1)
    return float(off.max()), float(house.rig[HOG_Y])


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("k1", "k2"), [(-0.19, 0.036), (-0.28, 0.07)])
def test_the_hog_line_tells_a_wide_lens(k1: float, k2: float, turned: bool) -> None:
    """By the circles alone guards are up to a metre from where they are."""
    off, hog = guards_off(club(k1, k2), turned=turned)
    assert off < 0.05
    assert hog == pytest.approx(-6.4 if turned else 6.4, abs=0.06)


def test_a_camera_that_leans_the_other_way_is_found() -> None:
    """Without a wide lens circles had one 14 m up, 3.8 m to the wrong side of the tee."""
    assert guards_off(club(-0.19, 0.036, y=-1.0, z=7.5), turned=True)[0] < 0.05


@pytest.mark.parametrize(
    "fills",
    [(), ((6.4, 9.0, 20),), ((6.1, 6.8, 20),), ((6.4, 9.0, 120), (6.4, 6.5, 20))],
)
def test_no_line_is_none(fills: tuple[tuple[float, float, int], ...]) -> None:
    """Nor are the edge of the ice, what is as wide as letters, or a border along what is no ice."""
    path, plain = club(-0.19, 0.036), replace(SCENE.sheet, hog_line=SCENE.sheet.ice)
    image = np.array(render_still(replace(SCENE, sheet=plain), path), np.uint8)
    for near, far, grey in fills:
        fill(image, path, (-2.5, 2.5), (near, far), grey)
    house = find_house(np.ascontiguousarray(np.rot90(image, 2)))
    assert house is not None and house.rig[HOG_Y] == pytest.approx(6.401)


def test_sweepers_over_half_of_it_do_not_hide_it() -> None:
    sweepers = (-1.7, -0.6), (0.2, 1.4)
    assert guards_off(club(-0.19, 0.036), turned=True, covered=sweepers)[0] < 0.05


def test_a_usual_lens_stays_one() -> None:
    for turned in (False, True):
        assert guards_off(club(-0.02, 0.0), turned=turned)[0] < 0.005


def test_a_house_without_a_hog_line_in_view_is_found_as_before() -> None:
    path = CameraPath((770, 440), (0.03, 0.0, 9.0), (Key(0.0, 0.0, 0.2, 90.0),))
    house = find_house(np.asarray(render_still(SCENE, path), np.uint8))
    assert house is not None and house.prior is OVERHEAD
    assert house.rig[HOG_Y] == pytest.approx(6.401)


@pytest.mark.parametrize("y", [-6.4, -6.2, -6.0])
def test_a_stripe_behind_the_house_is_no_hog_line(y: float) -> None:
    """The back line tells at which end it is; such a stripe had a camera 1.8 m too low."""
    path = CameraPath((1280, 720), (0.05, 0.1, 8.5), (Key(0.0, 0.0, -1.5, 65.0, k1=-0.02),))
    image = np.array(render_still(SCENE, path), np.uint8)
    fill(image, path, (-2.3, 2.3), (y, y + 0.1))
    house = find_house(image)
    assert house is not None and house.prior is OVERHEAD
    assert house.rig[HOG_Y] == pytest.approx(6.401)
    assert house.rig[POSITION][2] == pytest.approx(8.5, abs=0.2)


@pytest.mark.parametrize("y", [5.6, 5.7])
def test_letters_in_a_row_are_no_hog_line(y: float) -> None:
    """A sponsor's name, twice across the sheet, had a camera of a broadcast 1.8 m too low."""
    path = CameraPath((1280, 720), (-0.06, -0.05, 7.5), (Key(0.0, 0.0, 3.4, 140.0, k1=-0.09),))
    plain = replace(SCENE.sheet, hog_line=SCENE.sheet.ice)
    image = np.array(render_still(replace(SCENE, sheet=plain), path), np.uint8)
    for x in (*np.arange(-1.75, -0.4, 0.14), *np.arange(0.45, 1.8, 0.14)):
        fill(image, path, (x, x + 0.08), (y, y + 0.12), 60)
    house = find_house(image)
    assert house is not None and house.prior is OVERHEAD
    assert house.rig[POSITION][2] == pytest.approx(7.5, abs=0.2)


def test_from_aside_the_hog_line_tells_of_no_wide_lens() -> None:
    """It lies about where it should with each: one had a k1 of −0.09 there."""
    path = CameraPath((1280, 720), (0.3, 4.6, 8.0), (Key(0.0, 0.0, 2.0, 60.0),))
    house = find_house(np.ascontiguousarray(np.rot90(render_still(SCENE, path), 2)))
    assert house is not None and house.rig[HOG_Y] == pytest.approx(-6.4, abs=0.06)
    assert house.rig[K1] == pytest.approx(0.0, abs=0.03)
