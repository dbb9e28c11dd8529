from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.camera import tilted_camera
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.association.expected import FOLLOWED
from curlshot.vision.detection.appearance import BY_SHAPE, Appearance, any_stone, learn
from curlshot.vision.detection.measure import Measures, measure_discs
from curlshot.vision.detection.patch import EFFORT
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import plain_disc, search_picture
from curlshot.vision.optics.camera import Camera

PLACES = np.array([[0.3, 1.9], [-0.45, 0.3], [0.95, 0.1]])
SCENE = scene_of([(x, y, cap) for (x, y), cap in zip(PLACES, (RED, YELLOW, RED), strict=True)])
PICTURE = np.asarray(render_still(SCENE, CAMERA), np.uint8)
VIEW = camera_of(CAMERA, SCENE)


def measured(
    places: np.ndarray, picture: np.ndarray = PICTURE, learned: Appearance | None = None
) -> Measures:
    return measure_discs([Look(picture, VIEW, places)], learned or any_stone(), STONE)


@pytest.mark.parametrize("aside", [0.0, 0.02])
def test_centres_lie_where_the_stones_are_whatever_place_was_looked_at(aside: float) -> None:
    seen = measured(PLACES + np.array([aside, 0.5 * aside]))
    assert seen.ok.all()
    assert np.hypot(*(seen.centre - PLACES).T).max() < 0.005
    np.testing.assert_allclose(seen.shift, 1.118 * aside, atol=0.005)
    assert (seen.visible > 0.7).all() and (seen.uncovered > 0.8).all()
    np.testing.assert_allclose(seen.outline, 1, atol=0.05)
    assert np.abs(seen.bends).max() < 0.003


def test_a_stone_gives_evidence_and_bare_ice_or_paint_do_not() -> None:
    places = np.array([*PLACES, [0.8, 2.3], [-1.5, 0.2]])
    seen = measured(places)
    assert seen.evidence[:3].min() > 1.4
    assert not (seen.ok[3:] & (seen.evidence[3:] > 0.7)).any()


def test_of_a_stone_half_covered_half_is_seen_and_its_place_is_known_less_well() -> None:
    x, y = VIEW.project(PLACES[1:2], STONE.cap_height)[0].astype(int)
    covered = PICTURE.copy()
    covered[y - 40 : y + 40, x : x + 40] = (60, 90, 60)
    whole, half = measured(PLACES), measured(PLACES, covered)
    assert 0.2 < half.visible[1] < whole.visible[1] - 0.2
    assert half.uncovered[1] < 0.75
    assert half.sd[1].max() > 1.3 * whole.sd[1].max()
    np.testing.assert_allclose(half.sd[0], whole.sd[0])


def test_half_a_stone_on_one_side_says_more_than_more_of_it_here_and_there() -> None:
    learned = learn(search_picture(PICTURE, VIEW).stones)
    x, y = VIEW.project(PLACES[1:2], STONE.cap_height)[0].astype(int)
    down, across = np.mgrid[-40:40, -40:40]
    stripes = np.sin(6 * np.arctan2(down, across)) > 0
    seen = []
    for hidden in (across >= 0, stripes):
        covered = PICTURE.copy()
        covered[y - 40 : y + 40, x - 40 : x + 40][hidden] = (60, 90, 60)
        seen.append(measure_discs([Look(covered, VIEW, PLACES)], learned, STONE))
    half, scattered = seen
    assert half.visible[1] < scattered.visible[1] - 0.05
    assert half.evidence[1] > scattered.evidence[1] + 0.05


def test_dark_clothes_before_a_stone_are_not_taken_for_its_granite() -> None:
    x, y = VIEW.project(PLACES[1:2], STONE.cap_height)[0].astype(int)
    reach = round(0.6 * STONE.radius * float(VIEW.scale_at(PLACES[1])))
    covered = PICTURE.copy()
    covered[y - 60 : y + 60, x + reach : x + 90] = (10, 8, 8)
    whole, less = measured(PLACES), measured(PLACES, covered)
    assert less.visible[1] < whole.visible[1] - 0.1
    assert less.evidence[1] > whole.evidence[1] - 1.0


def test_light_ice_behind_a_low_shoulder_hardly_counts_against_a_stone() -> None:
    path, place = tilted_camera(np.radians(45)), np.array([[0.3, 2.9]])
    scene = scene_of([(*place[0], RED)])
    bare, camera = np.asarray(render_still(scene, path), np.uint8), camera_of(path, scene)
    angle = np.linspace(np.radians(50), np.radians(130), 20)
    arc = np.stack([np.cos(angle), np.sin(angle)], -1)
    ring = [camera.project(place + r * STONE.radius * arc, 0.09) for r in (0.93, 1.1)]
    outline = np.concatenate([ring[0], ring[1][::-1]]).round().astype(np.int32)
    evidence = []
    for grey in (115, 220):
        behind = cv2.fillPoly(bare.copy(), [outline], (grey,) * 3)
        seen = measure_discs([Look(behind, camera, place)], any_stone(), STONE)
        evidence.append(seen.evidence[0])
    assert evidence[1] > evidence[0] - 0.4


def test_a_lamp_from_one_side_draws_the_edge_by_lightness_aside() -> None:
    seen = measured(PLACES)
    assert np.hypot(*seen.light.T).max() < 0.003
    x, y = VIEW.project(PLACES[1:2], STONE.cap_height)[0]
    down, across = np.mgrid[: PICTURE.shape[0], : PICTURE.shape[1]]
    near = np.hypot(across - x, down - y) < 0.97 * STONE.radius * float(VIEW.scale_at(PLACES[1]))
    lit = 1 + 0.35 * near * np.sign(across - x)
    shaded = np.clip(PICTURE * lit[..., None], 0, 255).astype(np.uint8)
    again = measured(PLACES, shaded)
    aside = np.abs(again.light - seen.light)
    assert aside[1].max() > 2 * aside[[0, 2]].max() + 2e-4


def test_where_colours_hardly_tell_caps_what_tells_more_counts_place_by_place() -> None:
    learned = learn(search_picture(PICTURE, VIEW).stones)
    assert learned is not None and learned.membership is not None
    look = Look(PICTURE, VIEW, PLACES)
    for table in (0 * learned.membership, -learned.membership):
        for own in (False, True):
            known = replace(learned, membership=table, own=own)
            seen = measure_discs([look], known, STONE)
            assert seen.ok.all() == (seen.evidence.min() > 2) == own
    covered = PICTURE.copy()
    for x, y in VIEW.project(PLACES, STONE.cap_height).round().astype(int):
        covered[y - 30 : y + 30, x : x + 30] = (120, 40, 30)
    seen = measure_discs([Look(covered, VIEW, PLACES)], replace(learned, own=True), STONE)
    assert seen.ok.all() and seen.evidence.min() > 1


def test_coarse_hues_excuse_no_size_that_lightness_tells() -> None:
    small = replace(STONE, cap_radius=0.9 * STONE.cap_radius)
    grey = cv2.cvtColor(cv2.cvtColor(PICTURE, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    more = []
    for picture in (PICTURE, grey):
        look = Look(picture, VIEW, PLACES[:2])
        assert not measure_discs([look], BY_SHAPE, small, EFFORT).excused.any()
        more.append(measure_discs([look], BY_SHAPE, small, FOLLOWED).excused)
    assert more[0].min() > 0.3
    np.testing.assert_allclose(more[1], 0, atol=0.02)


def test_of_a_plain_disc_the_rim_tells() -> None:
    seen = measure_discs([Look(PICTURE, VIEW, PLACES[:1])], None, plain_disc(STONE.radius))
    assert seen.ok[0]
    assert seen.evidence[0] > 0.5
    assert seen.outline.shape == (1, 1)
    assert np.isnan(seen.light).all()


@pytest.mark.parametrize("aside", [-12, -5, 0, 5, 12])
def test_paint_that_ends_under_a_plain_disc_does_not_draw_it_aside(aside: float) -> None:
    scale, size = 20 / STONE.radius, 201
    flat = np.array([[scale, 0, 100.3], [0, -scale, 99.6], [0, 0, 1]])
    x, y = np.meshgrid(np.arange(size, dtype=float), np.arange(size, dtype=float))
    picture = np.empty((size, size, 3))
    picture[:] = (226, 224, 220)
    for distance, colour in (
        (x - 100.3 - aside, (120, 126, 20)),
        (np.hypot(x - 100.3, y - 99.6) - 20, (118, 122, 120)),
    ):
        picture += np.clip(0.5 - distance, 0, 1)[..., None] * (np.array(colour) - picture)
    blurred = cv2.GaussianBlur(picture, (0, 0), 0.8)
    look = Look(np.round(blurred).astype(np.uint8), Camera(0, 0.0, flat, (size, size)), PLACES * 0)
    seen = measure_discs([look], None, plain_disc(STONE.radius))
    assert np.abs(seen.centre).max() < 0.05 / scale
