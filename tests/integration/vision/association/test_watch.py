from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.sheet import STONE, Stone
from curlshot.synthetic.camera import still_camera
from curlshot.synthetic.clip import render_still
from curlshot.synthetic.scenes import PAINTS
from curlshot.tests.helpers.vision.stones import (
    BLUE,
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.tests.helpers.vision.watch import AT_REST, lasting, picture
from curlshot.vision.association.watch import Watch
from curlshot.vision.detection.placing import placed_by
from curlshot.vision.detection.stones import (
    plain_disc,
)
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.video.frame import Frame

LATE = (-0.2, -0.5)
PALE = (210, 150, 70)


@pytest.mark.parametrize("cap", [YELLOW, BLUE])
def test_a_stone_found_late_is_followed_back_also_one_of_a_new_colour(
    cap: tuple[int, int, int],
) -> None:
    reds = [(x, y, RED) for x, y, _ in AT_REST]
    before, after = picture(reds), picture([*reds, (*LATE, cap)])
    camera, since = camera_of(CAMERA, scene_of(reds)), 27
    watch = Watch()
    for index in range(50):
        watch.look(Frame(index, index / 25, after if index >= since else before), camera)
    counts = [len(detections) for _, _, detections in watch.finish(lasting(camera))]
    assert counts == [3] * since + [4] * (50 - since)


def test_in_the_end_stones_are_placed_by_the_cameras_that_are_known_by_then() -> None:
    """At their times; a picture without a camera, and a camera without one, are left out."""
    image, camera = picture(AT_REST), camera_of(CAMERA, scene_of(AT_REST))
    watches = Watch(), Watch()
    for index in range(12):
        for watch in watches:
            watch.look(Frame(index, index / 25, image), camera)
    known = [
        replace(camera, frame=index, t=index / 24, k1=0.01 * index) for index in [*range(1, 12), 99]
    ]
    seen = {frame: detections for frame, _, detections in watches[0].finish(lasting(camera))}
    found = list(watches[1].finish(known))
    assert [(frame, t) for frame, t, _ in found] == [(k, k / 24) for k in range(1, 12)]
    for (frame, _, detections), by in zip(found, known, strict=False):
        (expected,) = placed_by([by], [seen[frame]], STONE)
        assert len(detections) == len(AT_REST)
        told, places = ([(s.x, s.y) for s in each] for each in (detections, expected))
        np.testing.assert_allclose(told, places)


def test_places_of_caps_that_show_large_are_less_sure_along_the_view() -> None:
    image, camera = picture(AT_REST), camera_of(CAMERA, scene_of(AT_REST))
    watches, stated = (Watch(), Watch()), []
    for watch, share in zip(watches, (1.0, 1.15), strict=True):
        for index in range(24):
            watch.look(Frame(index, index / 25, image), camera)
        assert watch.appearance is not None
        # How large they show does not move them, it says how sure they are.
        watch.appearance = replace(watch.appearance, outline=(share, watch.appearance.outline[1]))
        *_, (_, _, seen) = watch.finish(lasting(camera))
        stated.append([(s.x, s.y, *s.sd_place) for s in seen])
    (*usual, sd_x, sd_y), (*large, more_x, more_y) = np.transpose(stated, (0, 2, 1))
    np.testing.assert_array_equal(usual, large)
    slant = np.abs(Cameras.of([camera], [len(AT_REST)]).slants(np.transpose(usual)))
    added = np.sqrt(np.transpose([more_x, more_y]) ** 2 - np.transpose([sd_x, sd_y]) ** 2)
    np.testing.assert_allclose(added, 0.15 * STONE.cap_radius * slant, rtol=0.01)


def test_a_third_colour_does_not_take_the_place_of_one_on_the_ice() -> None:
    places = [*AT_REST, (-0.3, -0.5, YELLOW), (0.5, 0.9, BLUE)]
    image, camera = picture(places), camera_of(CAMERA, scene_of(places))
    watch = Watch()
    learned = set()
    for index in range(150):
        watch.look(Frame(index, index / 25, image), camera)
        if watch.appearance is not None:
            learned.add(tuple(cap.name for cap in watch.appearance.caps))
    assert len(learned) == 1
    assert [len(detections) for _, _, detections in watch.finish(lasting(camera))] == [4] * 150


def test_a_stone_that_convinces_in_some_pictures_only_is_learned_from_these() -> None:
    clear = picture(AT_REST[:1])
    camera = camera_of(CAMERA, scene_of(AT_REST[:1]))
    x, y = camera.project(np.array([AT_REST[0][:2]]), 0.12)[0].astype(int)
    covered = clear.copy()
    covered[y - 60 : y + 60, x - 60 : x + 1] = (60, 90, 60)
    watch = Watch()
    for index in range(24):
        # Of the pictures looked at first, every eighth, none is clear.
        watch.look(Frame(index, index / 25, clear if index in (2, 10, 20) else covered), camera)
    assert [len(detections) for _, _, detections in watch.finish(lasting(camera))] == [1] * 24


@pytest.mark.parametrize("disc", [STONE, plain_disc(STONE.radius)])
def test_a_stone_seen_before_somebody_stands_over_it_is_seen_from_the_first_picture_on(
    disc: Stone,
) -> None:
    clear = picture(AT_REST)
    camera = camera_of(CAMERA, scene_of(AT_REST))
    x, y = camera.project(np.array([AT_REST[0][:2]]), 0.12)[0].astype(int)
    covered = clear.copy()
    covered[y - 60 : y + 60, x - 60 : x + 60] = (60, 90, 60)
    watch = Watch(disc)
    for index in range(50):
        watch.look(Frame(index, index / 25, clear if index < 6 else covered), camera)
    counts = [len(detections) for _, _, detections in watch.finish(lasting(camera))]
    assert counts == [3] * 6 + [2] * 44


def test_a_dull_cap_on_vivid_paint_is_learned_beside_a_vivid_one() -> None:
    path = still_camera(px_per_m=140.0, target=(0.0, 0.6), position=(0.3, -5.2, 8.0))
    dull = (66, 62, 110)
    scene = scene_of([(0.3, 0.25, dull), (-0.8, 1.0, YELLOW)], paint=PAINTS["navy-orange"])
    image, camera = np.asarray(render_still(scene, path), np.uint8), camera_of(path, scene)
    watch = Watch()
    for index in range(24):
        watch.look(Frame(index, index / 25, image), camera)
    assert [len(detections) for _, _, detections in watch.finish(lasting(camera))] == [2] * 24


def test_a_stone_that_is_hit_under_cover_is_found_in_the_moment_that_shows_it() -> None:
    here, there = picture(AT_REST), picture([(0.3, -0.3, RED), *AT_REST[1:]])
    camera = camera_of(CAMERA, scene_of(AT_REST))
    watch = Watch()
    for index in range(70):
        image = (here if index < 30 else there).copy()
        if 26 <= index < 33 or 42 <= index < 66:
            for x, y in camera.project(np.array([(0.3, 0.2), (0.3, -0.3)]), 0.12).astype(int):
                image[y - 50 : y + 50, x - 50 : x + 50] = (60, 90, 60)
        watch.look(Frame(index, index / 25, image), camera)
    counts = [len(detections) for _, _, detections in watch.finish(lasting(camera))]
    assert counts == [3] * 26 + [2] * 7 + [3] * 9 + [2] * 24 + [3] * 4


def test_stones_that_show_briefly_after_a_bare_beginning_are_seen() -> None:
    bare, shown, left = picture([]), picture(AT_REST), picture(AT_REST[1:])
    watch, camera = Watch(), camera_of(CAMERA, scene_of(AT_REST))
    for index in range(40):
        image = bare if index < 10 else shown if index < 27 else left
        watch.look(Frame(index, index / 25, image), camera)
    counts = [len(detections) for _, _, detections in watch.finish(lasting(camera))]
    assert counts == [0] * 10 + [3] * 17 + [2] * 13


def test_a_stone_hidden_soon_after_it_was_found_is_looked_for_where_it_went() -> None:
    # All are found in the picture 31, looking back to 8, and the first is hidden from 33 on.
    hit = [(-0.2, -0.5, RED), *AT_REST[1:]]
    rest, without, moved = picture(AT_REST), picture(AT_REST[1:]), picture(hit)
    images = [without] * 8 + [rest] * 25 + [without] * 11 + [moved] * 10 + [without] * 26
    watch, camera = Watch(), camera_of(CAMERA, scene_of(AT_REST))
    for index, image in enumerate(images):
        watch.look(Frame(index, index / 25, image), camera)
    counts = [len(detections) for _, _, detections in watch.finish(lasting(camera))]
    assert counts == [2] * 8 + [3] * 25 + [2] * 11 + [3] * 10 + [2] * 26


@pytest.mark.parametrize("jump", [0.02, 0.025, 0.03, 0.13])
def test_a_stone_that_jumps_is_found_again_at_once(jump: float) -> None:
    here, there = picture(AT_REST), picture([(0.3, 0.2 - jump, RED), *AT_REST[1:]])
    watch, camera = Watch(), camera_of(CAMERA, scene_of(AT_REST))
    for index in range(12):
        watch.look(Frame(index, index / 25, there if index >= 7 else here), camera)
    for index, _, detections in watch.finish(lasting(camera)):
        places = np.array([(s.x, s.y) for s in detections])
        assert len(places) == 3
        true = (0.3, 0.2 - jump if index >= 7 else 0.2)
        assert np.hypot(*(places - true).T).min() < 0.006


def test_a_stone_that_spins_on_the_spot_is_measured_all_the_time() -> None:
    scene = scene_of(AT_REST)
    camera = camera_of(CAMERA, scene)
    watch = Watch()
    for index in range(30):
        first = scene.stones[0]
        turned = replace(first, start=replace(first.start, theta=0.02 * index))
        image = render_still(replace(scene, stones=(turned, *scene.stones[1:])), CAMERA)
        watch.look(Frame(index, index / 25, np.asarray(image, np.uint8)), camera)
    told = {True: 0, False: 0}
    for _, _, detections in watch.finish(lasting(camera)):
        for detection in detections:
            spins = np.hypot(detection.x - AT_REST[0][0], detection.y - AT_REST[0][1]) < 0.05
            told[bool(spins)] += detection.spectrum is not None
    assert told[True] > 25
    assert told[False] < 40


def test_caps_are_known_in_a_light_that_has_wandered_and_after_a_fade() -> None:
    places = [(x, y, PALE) for x, y, _ in AT_REST]
    image, camera = picture(places) * 0.85, camera_of(CAMERA, scene_of(places))
    watch = Watch()
    for index in range(100):
        faded = min(0.1 + 0.06 * index, 1.0)
        yellow = np.array([1 - 0.004 * index, 1.0, 1 + 0.001 * index])
        lit = (image * (faded * yellow)).clip(0, 255).astype(np.uint8)
        watch.look(Frame(index, index / 25, lit), camera)
    counts = [len(detections) for _, _, detections in watch.finish(lasting(camera))]
    assert counts[16:] == [3] * 84


def test_stones_of_a_dark_recording_are_learned_and_followed_with_its_tones_lifted() -> None:
    image, camera = picture(AT_REST), camera_of(CAMERA, scene_of(AT_REST))
    dark = np.round(255 * (image / 255) ** 2.2).astype(np.uint8)
    usual, lifted = Watch(), Watch()
    for index in range(30):
        usual.look(Frame(index, index / 25, image), camera)
        lifted.look(Frame(index, index / 25, dark), camera)
    found = [seen for _, _, seen in lifted.finish(lasting(camera))]
    assert [len(seen) for seen in found] == [3] * 30
    for place in AT_REST:  # those pictures that come once the stones are learned, too
        same = [
            stone
            for seen in found
            for stone in seen
            if np.hypot(stone.x - place[0], stone.y - place[1]) < 0.1
        ]
        assert np.ptp([stone.colour for stone in same], axis=0).max() < 10
    assert usual.appearance is not None and lifted.appearance is not None
    for cap in usual.appearance.caps:
        assert lifted.appearance.nearest(cap.mean)[1] < 25
