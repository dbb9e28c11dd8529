from __future__ import annotations

from dataclasses import replace

import numpy as np

from data.sheet import STONE
from tests.vision.test_follow import sighting
from vision.camera import PARAMETERS, CameraError
from vision.placing import ASTRAY, GIVEN_ASTRAY, placed_by
from vision.pose import View, camera
from vision.rig import OVERHEAD, start_rig

HEIGHT, FOCAL = 8.0, 1200.0
RIG = start_rig(OVERHEAD, (0.0, 0.0, HEIGHT))
RIG[3:6] = 0
DOWN = replace(camera(View(np.array([0, 0, 0, np.log(FOCAL)])), RIG, (1280, 720)), rms_px=0.2)
PLACES = [(0.0, 0.5), (1.5, -1.0), (-2.0, 2.0)]


def test_places_are_those_under_the_pixels_with_the_caps_height_taken_out() -> None:
    pixels = DOWN.project(np.array(PLACES), STONE.cap_height).tolist()
    seen = [sighting((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    found = placed_by(DOWN, seen, STONE)
    np.testing.assert_allclose([(s.x, s.y) for s in found], PLACES, atol=1e-6)
    np.testing.assert_allclose([s.pixel_size for s in found], HEIGHT / FOCAL, rtol=0.01)
    assert placed_by(DOWN, [], STONE) == []


def test_what_sightings_share_is_the_camera_s_and_grows_where_it_looks_aslant() -> None:
    pixels = DOWN.project(np.array(PLACES), STONE.cap_height).tolist()
    seen = [sighting((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    errors = [s.sd_place for s in placed_by(DOWN, seen, STONE)]
    assert errors == sorted(errors)
    flat = [s.sd_place for s in placed_by(DOWN, seen, replace(STONE, cap_height=0.0))]
    np.testing.assert_allclose(flat, GIVEN_ASTRAY * 0.2 * HEIGHT / FOCAL, rtol=0.01)
    rough = placed_by(replace(DOWN, rms_px=2.0), seen, STONE)
    assert all(s.sd_place > e for s, e in zip(rough, errors, strict=True))


def test_the_map_of_a_house_is_the_worse_the_farther_from_the_tee() -> None:
    error = CameraError(np.zeros((PARAMETERS, PARAMETERS)), np.zeros((PARAMETERS, PARAMETERS)))
    flat, pixels = replace(STONE, cap_height=0.0), DOWN.project(np.array(PLACES)).tolist()
    seen = [sighting((9.0, 9.0))._replace(pixel=(u, v)) for u, v in pixels]
    errors = [s.sd_place for s in placed_by(replace(DOWN, error=error), seen, flat)]
    away = np.hypot(*np.array(PLACES).T)
    np.testing.assert_allclose(errors, ASTRAY * 0.2 * HEIGHT / FOCAL * away, rtol=0.01)
