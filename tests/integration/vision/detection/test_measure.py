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
from curlshot.vision.detection.appearance import Appearance, Colour, learn
from curlshot.vision.detection.edges import OPEN
from curlshot.vision.detection.measure import measure_discs
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import FOLLOWING, search_picture
from curlshot.vision.detection.strangers import strangers

PLACES = np.array([[0.3, 1.9], [-0.45, 0.3], [0.95, 0.1]])
SCENE = scene_of([(x, y, cap) for (x, y), cap in zip(PLACES, (RED, YELLOW, RED), strict=True)])
VIEW = camera_of(CAMERA, SCENE)


def test_granite_that_hides_behind_its_cap_does_not_count_as_covered() -> None:
    """Two stones on yellow paint that are told alike, whichever shows a little less granite."""
    path, places = tilted_camera(np.radians(57), px_per_m=95.0), np.array([[-1.2, 0.9], [1.2, 0.9]])
    scene = scene_of([(x, y, RED) for x, y in places.tolist()])
    scene = replace(scene, paint=replace(scene.paint, twelve=(20, 170, 220)))
    picture, camera = np.asarray(render_still(scene, path), np.uint8), camera_of(path, scene)
    coded = cv2.cvtColor(picture, cv2.COLOR_BGR2YCrCb)
    half = cv2.resize(coded, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    chroma = cv2.resize(half, picture.shape[1::-1])
    coded = np.concatenate([coded[..., :1], chroma[..., 1:]], axis=2)
    picture = np.asarray(cv2.cvtColor(coded, cv2.COLOR_YCrCb2BGR), np.uint8)
    cap = Colour(np.array([90.0, 180.0, 155.0]), 20 * np.eye(3))
    learned = Appearance(None, caps=(cap,), own=True, wall=(0.006, 0.002))
    seen = measure_discs(
        [Look(picture, camera, places + np.array([0.003, -0.004]))], learned, STONE
    )
    assert seen.visible.min() < OPEN
    off = (seen.centre - places)[:, 1]
    assert abs(off[0] - off[1]) < 0.003 and np.abs(off).max() < 0.008


@pytest.mark.parametrize("begin", [20, 200])
def test_seen_aslant_a_light_mark_beside_the_rim_hardly_draws_a_cap_aside(
    begin: int,
) -> None:
    path = tilted_camera(np.radians(40))
    picture, camera = np.asarray(render_still(SCENE, path), np.uint8), camera_of(path, SCENE)
    angle = np.radians(np.arange(begin, begin + 121, 4))
    arc = PLACES[1] + 0.0865 * np.stack([np.cos(angle), np.sin(angle)], -1)
    line = (16 * camera.project(arc, STONE.cap_height)).round().astype(np.int32)
    marked = cv2.polylines(picture.copy(), [line], False, (225,) * 3, 1, cv2.LINE_AA, 4)
    learned = learn(search_picture(picture, camera).stones)

    centres = [
        measure_discs(
            [Look(cv2.GaussianBlur(image, (0, 0), 0.7), camera, PLACES)], learned, STONE
        ).centre
        for image in (marked, picture)
    ]
    aside = np.hypot(*(centres[0] - centres[1]).T)
    assert aside[1] < 3e-4
    np.testing.assert_allclose(aside[[0, 2]], 0, atol=2e-5)


MAGENTA = (240, 30, 180)


def teal_on_magenta(cap_radius: float = STONE.cap_radius) -> np.ndarray:
    scene = scene_of([(x, y, (133, 127, 34)) for x, y in PLACES])
    stones = tuple(replace(stone, cap_radius=cap_radius) for stone in scene.stones)
    rings = replace(scene.paint, twelve=MAGENTA, eight=MAGENTA, four=MAGENTA, outline=None, logo="")
    return np.asarray(render_still(replace(scene, stones=stones, paint=rings), CAMERA), np.uint8)


def coarsely_coloured(picture: np.ndarray, block: int, aside: int) -> np.ndarray:
    """Give each block of so many pixels one hue, and let it fade from one to the next."""
    coded = cv2.cvtColor(np.roll(picture, (aside, aside), (0, 1)), cv2.COLOR_BGR2YCrCb)
    height, width = (block * (size // block) for size in coded.shape[:2])
    few = cv2.resize(
        coded[:height, :width, 1:], (width // block, height // block), interpolation=cv2.INTER_AREA
    )
    coded[:height, :width, 1:] = cv2.resize(few, (width, height))
    return np.roll(cv2.cvtColor(coded, cv2.COLOR_YCrCb2BGR), (-aside, -aside), (0, 1))


@pytest.mark.parametrize("block", [6, 8])
def test_hues_coded_in_blocks_hide_no_stone(block: int) -> None:
    picture = teal_on_magenta()
    learned = learn(search_picture(picture, VIEW).stones)
    coded = [coarsely_coloured(picture, block, aside) for aside in range(0, block, 2)]
    seen = measure_discs([Look(each, VIEW, PLACES) for each in coded], learned, STONE, FOLLOWED)
    assert seen.outline[:, 0].max() > 1.06
    assert (
        seen.evidence.min() < FOLLOWING.min_repeated_evidence < (seen.evidence + seen.excused).min()
    )


def test_steeply_aslant_coarse_hues_draw_no_cap_on_paint_towards_the_camera() -> None:
    places = np.array([[x, y] for x in (-0.9, -0.3, 0.3, 0.9) for y in (-0.6, 0.3, 1.1)])
    scene = scene_of([(x, y, (44, 26, 178)) for x, y in places.tolist()])
    paint = (180, 80, 20)
    rings = replace(
        scene.paint, twelve=paint, eight=paint, four=paint, button=paint, outline=None, logo=""
    )
    path = tilted_camera(np.radians(52), px_per_m=80.0)
    picture = render_still(replace(scene, paint=rings), path, supersample=2)
    camera, off = camera_of(path, scene), []
    for aside in (0, 1):
        coded = coarsely_coloured(np.asarray(picture, np.uint8), 2, aside)
        learned = learn(search_picture(coded, camera).stones)
        off.append(measure_discs([Look(coded, camera, places)], learned, STONE).centre - places)
    assert np.abs(np.mean(off, axis=(0, 1))).max() < 0.0015
    assert np.sqrt(np.square(off).mean(axis=(0, 1))).max() < 0.0027


def test_a_cap_of_another_size_speaks_against_a_stone_also_by_colours_that_are_known() -> None:
    right, large = (teal_on_magenta(size * STONE.cap_radius) for size in (1.0, 1.2))
    learned = learn(search_picture(right, VIEW).stones)
    seen = [
        measure_discs([Look(each, VIEW, PLACES)], learned, STONE, FOLLOWED)
        for each in (right, large)
    ]
    assert (seen[1].evidence + seen[1].excused < seen[0].evidence - 0.8).all()
    slightly = Look(teal_on_magenta(1.12 * STONE.cap_radius), VIEW, PLACES)
    excused = measure_discs([slightly], learned, STONE, FOLLOWED).excused
    assert excused.min() > 0.8 and excused.max() < 1.0


def test_black_caps_aslant_end_where_granite_and_ice_mix_with_them() -> None:
    """Half-way to the granite, or by what a fast stone covered, they lay 5 to 7 mm too near."""
    places = np.array([[x, y] for x in (-1.1, 0.2, 1.0) for y in (-0.6, 0.5, 1.6)])
    black, white = (32, 30, 30), (232, 234, 234)
    caps = [black if k % 2 else white for k in range(len(places))]
    scene = scene_of([(x, y, cap) for (x, y), cap in zip(places.tolist(), caps, strict=True)])
    path = tilted_camera(np.radians(40), px_per_m=60.0)
    picture = np.asarray(render_still(scene, path, supersample=3), np.uint8)
    camera = camera_of(path, scene)
    (found,), _ = strangers([Look(picture, camera, places[:0])], STONE, FOLLOWING)
    learned, way = learn(found.stones), np.tile([0.0, -0.08], (len(places), 1))
    still, fast = (
        measure_discs([Look(picture, camera, places, drift)], learned, STONE)
        for drift in (None, way)
    )
    dark = np.array(caps)[:, 0] < 100
    for seen in (still, fast):
        off = (seen.centre - places)[dark]
        assert np.sqrt(np.square(off).mean(0)).max() < 0.002
    assert fast.swept[dark].all() and not still.swept.any()
    # How far such an edge is drawn out is stated, and no edge by lightness steadies the place.
    more = np.sqrt(fast.sd[dark, 1] ** 2 - still.sd[dark, 1] ** 2)
    assert (more > 0.001).all() and (more < 0.003).all()
    assert np.isnan(fast.light[dark]).all()
