from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.sheet import STONE, Stone
from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.detection.placing import (
    CAP_END_SD,
    GIVEN_ASTRAY,
    MIXED_SD,
    USUAL_RMS_PX,
    placed_by,
)
from curlshot.vision.optics.camera import Camera, CameraError
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.optics.projection import PARAMETERS
from curlshot.vision.optics.rig import OVERHEAD, start_rig

HEIGHT, FOCAL = 8.0, 1200.0
RIG = start_rig(OVERHEAD, (0.0, 0.0, HEIGHT))
RIG[3:6] = 0
DOWN = replace(camera(View(np.array([0, 0, 0, np.log(FOCAL)])), RIG, (1280, 720)), rms_px=0.2)
PLACES = [(0.0, 0.5), (1.5, -1.0), (-2.0, 2.0)]


def test_places_are_those_under_the_pixels_with_the_caps_height_taken_out() -> None:
    pixels = DOWN.project(np.array(PLACES), STONE.cap_height).tolist()
    seen = [detection((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    found, none = placed_by([DOWN, DOWN], [seen, []], STONE)
    np.testing.assert_allclose([(s.x, s.y) for s in found], PLACES, atol=1e-6)
    np.testing.assert_allclose([s.pixel_size for s in found], HEIGHT / FOCAL, rtol=0.01)
    assert none == []
    assert placed_by([DOWN], [[]], STONE) == [[]]


def stated(camera: Camera, disc: Stone = STONE) -> np.ndarray:
    pixels = DOWN.project(np.array(PLACES), disc.cap_height).tolist()
    seen = [detection((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    return np.array([s.sd_place for s in placed_by([camera], [seen], disc)[0]])


def test_what_detections_share_is_the_camera_s_and_what_a_slant_hides() -> None:
    pixel = HEIGHT / FOCAL
    flat = stated(DOWN, replace(STONE, cap_height=0.0))
    np.testing.assert_allclose(flat, GIVEN_ASTRAY * 0.2 * pixel, rtol=0.01)
    slant = np.array(PLACES) / HEIGHT
    aslant = np.interp(np.hypot(*slant.T), *CAP_END_SD)[:, None] * np.abs(slant)
    np.testing.assert_allclose(stated(DOWN), np.hypot(flat, aslant), rtol=0.01)
    assert (stated(replace(DOWN, rms_px=2.0)) > stated(DOWN)).all()
    unknown, usual = (replace(DOWN, rms_px=rms) for rms in (np.nan, USUAL_RMS_PX))
    np.testing.assert_array_equal(stated(unknown), stated(usual))


def height(slant: float, cap_radius: float = STONE.cap_radius) -> float:
    """Give the error along the view as one of the height at which the edge of a cap is seen, m."""
    away = RIG.copy()
    away[:2] = -slant * HEIGHT * np.array([0.6, 0.8])
    down = camera(View(np.array([0, 0, 0, np.log(FOCAL)])), away, (9000, 9000))
    pixel = down.project(np.zeros((1, 2)), STONE.cap_height)[0]
    seen = [detection((0.0, 0.0))._replace(pixel=(float(pixel[0]), float(pixel[1])))]
    disc = replace(STONE, cap_radius=cap_radius)
    x, y = placed_by([replace(down, rms_px=0.0)], [seen], disc)[0][0].sd_place
    # All of it lies along the view, nothing across.
    np.testing.assert_allclose(x / y, 0.75, rtol=1e-6)
    return float(np.hypot(x, y)) / slant


def test_along_the_view_a_place_is_as_unsure_as_the_height_of_its_cap() -> None:
    # Granite is 114.3 mm high at least; caps that were drawn to be true end at 117 to 123 mm.
    for slant in (0.35, 0.5, 0.8):
        assert 0.002 < height(slant) < 0.0045
    # From above either end of the side of a cap, 6 to 16 mm high, may be taken for its edge.
    assert 0.005 < height(0.06) < 0.01
    assert height(0.02) == pytest.approx(height(0.06))
    assert height(0.35) < height(0.15) < height(0.06)
    # Where the far shoulder hides behind the cap, other things end there.
    assert height(0.8) < height(1.0) < height(1.1)
    assert 0.004 < height(1.3) < 0.0065
    # Yet whoever looks more aslant hardly ever knows better where a stone is along the view.
    told = [slant * height(slant) for slant in np.linspace(0.02, 1.3, 40)]
    assert (np.diff(told) > -1e-4).all()


def test_of_large_caps_it_is_less_sure_by_what_they_leave_of_the_granite() -> None:
    usual, large = height(0.5), height(0.5, STONE.cap_radius + 0.0145)
    np.testing.assert_allclose(np.sqrt(large**2 - usual**2), 0.0145, rtol=0.01)
    assert height(0.5, STONE.cap_radius + 0.001) < 1.1 * usual
    assert height(0.5, 0.09) == usual
    # Far aslant a usual cap hides its granite, too: there it is no more that one cap is larger.
    steep, more = height(1.2), height(1.2, STONE.cap_radius + 0.0145)
    assert 0.007 < 1.2 * np.sqrt(more**2 - steep**2) < 0.012


def test_the_map_of_a_house_is_the_worse_the_farther_from_the_tee() -> None:
    known = CameraError(np.zeros((PARAMETERS, PARAMETERS)), np.zeros((PARAMETERS, PARAMETERS)))
    errors = stated(replace(DOWN, error=known), replace(STONE, cap_height=0.0))
    away = np.hypot(*np.array(PLACES).T)
    expected = 0.15 * 0.2 * HEIGHT / FOCAL * np.column_stack([away, away])
    np.testing.assert_allclose(errors, expected, rtol=0.01)


def test_a_camera_uncertain_on_one_axis_leaves_the_other_certain() -> None:
    aside = np.zeros((PARAMETERS, PARAMETERS))
    aside[4, 4] = 0.5**2
    certain = CameraError(np.zeros_like(aside), np.zeros_like(aside))
    doubted = stated(replace(DOWN, error=replace(certain, shared=aside)))
    # Half a metre of the camera's place, seen from the height of the cap.
    added = np.sqrt(doubted**2 - stated(replace(DOWN, error=certain)) ** 2)
    np.testing.assert_allclose(added[:, 1], 0, atol=1e-5)
    assert (added[:, 0] > 0.005).all()


def test_caps_without_hue_lie_less_surely_along_a_slanting_view() -> None:
    pixels = DOWN.project(np.array(PLACES), STONE.cap_height).tolist()
    black = np.array([60.0, 129.0, 127.0])
    seen = [detection((9.0, 9.0))._replace(pixel=(u, v), colour=black) for u, v in pixels]
    sd = np.array([s.sd_place for s in placed_by([DOWN], [seen], STONE)[0]])
    more = np.sqrt(np.maximum(sd**2 - stated(DOWN) ** 2, 0.0))
    np.testing.assert_allclose(more, MIXED_SD * np.abs(PLACES) / HEIGHT, atol=1e-9)
    assert 0.002 < MIXED_SD < 0.005
