from __future__ import annotations

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
    drawn,
    level,
    proved,
    seen,
)
from curlshot.vision.optics.pose import project
from curlshot.vision.sheet.house import find_house
from curlshot.vision.sheet.house_fit import HouseFit
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
