from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, Stone
from curlshot.synthetic.camera import CameraPath, still_camera
from curlshot.synthetic.clip import render_still
from curlshot.synthetic.plain import plain_pictures
from curlshot.synthetic.scene import Colour, Scene
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    misses,
    scene_of,
)
from curlshot.vision.association.watch import Watch
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.shape import CAPS, NO_BALLOT, elected
from curlshot.vision.detection.stones import SEARCH
from curlshot.vision.detection.strangers import strangers
from curlshot.vision.video.frame import Frame

PLACES = [(0.3, 0.2), (-0.8, 1.0), (0.9, -0.6), (-0.2, -1.4), (1.3, 1.2)]


def aslant(metres: float) -> CameraPath:
    """Look at the house from as many metres behind it as above it, or not quite."""
    return still_camera(
        size=(960, 540), px_per_m=100.0, target=(0.0, 0.2), position=(0.0, -metres, 7.5)
    )


def with_caps(radius: float, granite: Colour = (112, 120, 122)) -> Scene:
    scene = scene_of([(x, y, (RED, YELLOW)[n % 2]) for n, (x, y) in enumerate(PLACES)])
    stones = tuple(replace(one, cap_radius=radius, granite=granite) for one in scene.stones)
    return replace(scene, stones=stones)


def solid(scene: Scene, path: CameraPath) -> NDArray[np.uint8]:
    return np.asarray(render_still(scene, path), np.uint8)


def flat(scene: Scene, path: CameraPath) -> NDArray[np.uint8]:
    """Stones as two flat discs, one on the other."""
    ((_, image),) = plain_pictures(scene, path, [0.0])
    return np.asarray(image, np.uint8)


def found_in(image: NDArray[np.uint8], scene: Scene, path: CameraPath) -> tuple[float, Stone]:
    """Largest error of the places of a clip of one picture, m, and how stones are made there."""
    watch, camera = Watch(), camera_of(path, scene)
    watch.look(Frame(0, 0.0, image), camera)
    ((_, _, seen),) = watch.finish([camera])
    assert len(seen) == len(scene.stones)
    return float(misses(tuple(seen), scene).max()), watch.disc


@pytest.mark.parametrize(
    ("cap", "metres"), [(0.076, 0.0), (0.134, 0.0), (0.088, 5.0), (0.119, 5.0)]
)
def test_stones_are_found_whatever_the_size_of_their_caps(cap: float, metres: float) -> None:
    scene, path = with_caps(cap), aslant(metres) if metres else CAMERA
    miss, disc = found_in(solid(scene, path), scene, path)
    assert miss < 0.010
    assert disc.cap_radius == pytest.approx(cap, rel=0.1)
    assert disc.rim_height == STONE.rim_height


@pytest.mark.parametrize(("cap", "grey"), [(0.08, 170), (0.1045, 110)])
def test_flat_stones_are_found_from_far_aslant(
    cap: float, grey: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("curlshot.synthetic.plain.GRANITE_HEIGHT", STONE.cap_height)
    scene, path = with_caps(cap, (grey, grey, grey)), aslant(10.0)
    miss, disc = found_in(flat(scene, path), scene, path)
    assert miss < 0.020
    assert disc.rim_height == disc.cap_height


@pytest.mark.parametrize("metres", [0.0, 9.0])
def test_usual_stones_are_taken_as_such(metres: float) -> None:
    scene, path = with_caps(STONE.cap_radius), aslant(metres) if metres else CAMERA
    look = Look(solid(scene, path), camera_of(path, scene), np.empty((0, 2)))
    (found,), disc = strangers([look], STONE, SEARCH)
    assert len(found.stones) == len(PLACES)
    assert disc is STONE
    known = replace(STONE, cap_radius=0.09)
    assert strangers([look], known, SEARCH, made=True)[1] is known


def test_another_size_takes_more_than_a_little_more_for_it() -> None:
    usual = int(np.abs(CAPS - STONE.cap_radius / STONE.radius).argmin())
    say = np.array(NO_BALLOT)
    assert elected(say, STONE) == [STONE]
    say[[usual - 1, usual, usual + 1, 1]] = 0.9, 1.0, 0.9, 1.1
    assert elected(say, STONE) == [STONE]
    say[[1, 2]] = 3.0, 2.0
    usually, *others = elected(say, STONE)
    assert usually is STONE
    assert [one.cap_radius for one in others] == pytest.approx(CAPS[[1, 2]] * STONE.radius)
