from __future__ import annotations

from dataclasses import replace

import numpy as np

from data.sheet import STONE, Stone
from tests.vision.association.test_follow import sighting
from vision.detection.placing import ASLANT, GIVEN_ASTRAY, USUAL_RMS_PX, placed_by
from vision.optics.camera import Camera, CameraError
from vision.optics.pose import View, camera
from vision.optics.projection import PARAMETERS
from vision.optics.rig import OVERHEAD, start_rig

HEIGHT, FOCAL = 8.0, 1200.0
RIG = start_rig(OVERHEAD, (0.0, 0.0, HEIGHT))
RIG[3:6] = 0
DOWN = replace(camera(View(np.array([0, 0, 0, np.log(FOCAL)])), RIG, (1280, 720)), rms_px=0.2)
PLACES = [(0.0, 0.5), (1.5, -1.0), (-2.0, 2.0)]


def test_places_are_those_under_the_pixels_with_the_caps_height_taken_out() -> None:
    pixels = DOWN.project(np.array(PLACES), STONE.cap_height).tolist()
    seen = [sighting((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    found, none = placed_by([DOWN, DOWN], [seen, []], STONE)
    np.testing.assert_allclose([(s.x, s.y) for s in found], PLACES, atol=1e-6)
    np.testing.assert_allclose([s.pixel_size for s in found], HEIGHT / FOCAL, rtol=0.01)
    assert none == []
    assert placed_by([DOWN], [[]], STONE) == [[]]


def stated(camera: Camera, disc: Stone = STONE) -> np.ndarray:
    pixels = DOWN.project(np.array(PLACES), disc.cap_height).tolist()
    seen = [sighting((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    return np.array([s.sd_place for s in placed_by([camera], [seen], disc)[0]])


def test_what_sightings_share_is_the_camera_s_and_what_a_slant_hides() -> None:
    pixel = HEIGHT / FOCAL
    flat = stated(DOWN, replace(STONE, cap_height=0.0))
    np.testing.assert_allclose(flat, GIVEN_ASTRAY * 0.2 * pixel, rtol=0.01)
    slant = np.array(PLACES) / HEIGHT
    aslant = np.interp(np.hypot(*slant.T), *ASLANT)[:, None] * np.abs(slant)
    np.testing.assert_allclose(stated(DOWN), np.hypot(flat, aslant), rtol=0.01)
    assert (stated(replace(DOWN, rms_px=2.0)) > stated(DOWN)).all()
    unknown, usual = (replace(DOWN, rms_px=rms) for rms in (np.nan, USUAL_RMS_PX))
    np.testing.assert_array_equal(stated(unknown), stated(usual))


def test_a_cap_is_told_best_where_its_wall_is_seen_and_its_shoulder_behind_it() -> None:
    def along(slant: float) -> float:
        away = RIG.copy()
        away[:2] = -slant * HEIGHT * np.array([0.6, 0.8])
        down = camera(View(np.array([0, 0, 0, np.log(FOCAL)])), away, (9000, 9000))
        pixel = down.project(np.zeros((1, 2)), STONE.cap_height)[0]
        seen = [sighting((0.0, 0.0))._replace(pixel=(float(pixel[0]), float(pixel[1])))]
        x, y = placed_by([replace(down, rms_px=0.0)], [seen], STONE)[0][0].sd_place
        np.testing.assert_allclose(x / y, 0.75, rtol=1e-6)
        return float(np.hypot(x, y)) / slant

    from_above, aslant, steep = along(0.05), along(0.75), along(1.3)
    # From above the edge may be that of the top or the foot of a wall of some 16 mm.
    np.testing.assert_allclose(from_above, 0.016 / 2, rtol=0.05)
    np.testing.assert_allclose(along(0.02), from_above)
    assert 4 * aslant < from_above and 1.5 * aslant < steep < from_above
    assert along(0.6) < along(0.45) < along(0.2) < along(0.1) < from_above
    # Yet whoever looks more aslant never knows better where a stone is along the view.
    told = [slant * along(slant) for slant in np.linspace(0.02, 1.3, 40)]
    assert (np.diff(told) > -1e-4).all()
    assert 0.1 * along(0.1) > 0.0006
    assert aslant < along(1.0) < steep


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
