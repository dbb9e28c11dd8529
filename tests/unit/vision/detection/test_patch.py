from __future__ import annotations

import numpy as np

from curlshot.data.sheet import STONE
from curlshot.vision.detection.patch import (
    EFFORT,
    handle_radii,
    is_plain,
    over_caps,
    profile_of,
    unrolled,
)
from curlshot.vision.detection.rays import Look, cameras_of
from curlshot.vision.detection.stones import plain_disc
from curlshot.vision.optics.pose import View, camera
from curlshot.vision.optics.rig import OVERHEAD, start_rig
from curlshot.vision.video.picture import colours_at

HEIGHT, FOCAL = 8.0, 1200.0
RIG = start_rig(OVERHEAD, (0.0, 0.0, HEIGHT))
RIG[3:6] = 0
DOWN = camera(View(np.array([0.0, 0.0, 0.0, np.log(FOCAL)])), RIG, (1280, 720))
PLACES = np.array([[0.0, 0.0], [1.5, 0.0], [3.0, -4.0]])


def test_a_camera_straight_above_shows_all_places_at_one_scale() -> None:
    np.testing.assert_allclose(DOWN.scale_at(PLACES), FOCAL / HEIGHT, rtol=1e-6)


def test_rays_cover_the_cap_and_its_granite() -> None:
    profile = profile_of(STONE, EFFORT)
    top = profile.radius[: EFFORT.radii]
    assert top[0] < 0.5 * STONE.cap_radius and top[-1] > STONE.radius
    assert (handle_radii(STONE) < STONE.cap_radius).all()
    disc = plain_disc(0.03)
    assert is_plain(disc) and not is_plain(STONE)
    assert profile_of(disc, EFFORT).node_height.max() == 0


def test_rings_are_shown_that_lie_in_the_picture_and_on_the_cap_alone() -> None:
    picture = np.full((720, 1280, 3), (60, 90, 200), np.uint8)
    out = DOWN.ice(np.array([[1280.0 - 6, 400.0]]))[0]  # seen to a few pixels from its middle
    look = Look(picture, DOWN, np.array([[0.3, 0.0], [4.0, 0.0], out]))
    by = cameras_of([look])
    rays, handle = unrolled([look], by, STONE, EFFORT)
    assert rays.lab.shape == (3, EFFORT.rays, EFFORT.radii, 3)
    count = len(handle_radii(STONE))
    assert handle.shape == (3, EFFORT.rays, 2 * count, 3)
    shown = (handle > 0).any(-1)
    assert (shown == shown[:, :1]).all()  # a ring as a whole or not at all
    at_grip, at_cap = shown[:, 0, :count], shown[:, 0, count:]
    assert at_grip[0].all() and at_cap[0, -4:].all()
    # Aslant, the grip's plane lies before the cap's edge; at the picture's end nothing is whole.
    assert at_grip[1, 0] and not at_grip[1, -1] and at_cap[1, -1]
    assert not at_grip[2, -1] and not at_cap[2, -1]
    np.testing.assert_array_equal(handle[0, 0, -1], rays.lab[0, 0, 20] & 254)
    disc = plain_disc(0.03)
    assert unrolled([look], by, disc, EFFORT)[1].shape == (3, EFFORT.rays, count, 3)


def test_rays_over_a_cap_go_on_at_its_height() -> None:
    picture = np.random.default_rng(0).integers(0, 255, (720, 1280, 3), np.uint8)
    looks = [Look(picture, DOWN, PLACES[:2]), Look(255 - picture, DOWN, PLACES[1:])]
    by = cameras_of(looks)
    rays, _ = unrolled(looks, by, STONE, EFFORT)
    over = over_caps(looks, by, rays, STONE)
    falls = int(np.searchsorted(rays.radius, 0.1201))
    for name in ("bgr", "lab", "inside"):
        before, after = getattr(rays, name), getattr(over, name)
        np.testing.assert_array_equal(after[:, :, :falls], before[:, :, :falls])
    assert (over.bgr[:, :, -4:] != rays.bgr[:, :, -4:]).any()
    radius = float(rays.radius[-3])
    place = DOWN.project(PLACES[1] + [[0.0, radius]], STONE.cap_height)[0]
    for k, image in ((1, picture), (2, 255 - picture)):
        x, y = (np.full((1, 1), z, np.float32) for z in place)
        seen = colours_at(image, x, y)[0, 0].astype(int)
        assert np.abs(over.bgr[k, EFFORT.rays // 4, -3] - seen).max() < 12
