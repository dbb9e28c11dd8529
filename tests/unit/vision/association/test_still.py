from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import STONE
from curlshot.synthetic.clip import render_still
from curlshot.tests.helpers.vision.stones import (
    CAMERA,
    RED,
    YELLOW,
    camera_of,
    scene_of,
)
from curlshot.vision.association.still import Portrait, portraits, unchanged
from curlshot.vision.detection.stones import search_picture
from curlshot.vision.video.picture import Image

PLACES = [(0.3, 0.2, RED), (-0.8, 1.0, YELLOW), (0.9, -0.6, RED)]
VIEW = camera_of(CAMERA, scene_of(PLACES))


def picture(shift: tuple[float, float] = (0.0, 0.0), light: float = 1.0) -> Image:
    (x, y, cap), *others = PLACES
    scene = scene_of([(x + shift[0], y + shift[1], cap), *others])
    seen = np.asarray(render_still(scene, CAMERA), float)
    return np.clip(seen * light + 5 * (light - 1), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def known() -> list[Portrait]:
    image = picture()
    found = sorted(search_picture(image, VIEW).stones, key=lambda s: np.hypot(s.x - 0.3, s.y - 0.2))
    taken = portraits(image, VIEW, 0.0, found, STONE)
    assert len(taken) == 3
    return [portrait for portrait in taken if portrait is not None]


@pytest.mark.parametrize("light", [0.85, 1.0, 1.1])
def test_shifts_are_told_to_a_fraction_of_a_millimetre(known: list[Portrait], light: float) -> None:
    shift = np.array([0.002, -0.003])
    found = unchanged([(picture((0.002, -0.003), light), VIEW)], known, STONE)[0]
    for index, (detection, portrait) in enumerate(zip(found, known, strict=True)):
        assert detection is not None and not detection.measured
        moved = np.array([detection.x - portrait.detection.x, detection.y - portrait.detection.y])
        np.testing.assert_allclose(moved, shift if index == 0 else 0.0, atol=4e-4)
        pixel = VIEW.project(np.array([detection.x, detection.y]), STONE.cap_height)
        np.testing.assert_allclose(detection.pixel, pixel, atol=0.01)


def test_what_moves_turns_or_is_covered_is_not_taken_for_the_same(known: list[Portrait]) -> None:
    assert unchanged([(picture((0.03, 0.0)), VIEW)], known, STONE)[0][0] is None
    covered = picture()
    u, v = known[1].detection.pixel
    covered[round(v) : round(v) + 8, round(u) - 20 : round(u) + 20] = (40, 60, 200)
    seen = unchanged([(covered, VIEW)], known, STONE)[0]
    assert seen[1] is None
    assert seen[0] is not None and seen[2] is not None


def test_an_even_cover_is_not_taken_for_a_light_without_contrast(known: list[Portrait]) -> None:
    covered = picture()
    u, v = known[1].detection.pixel
    covered[round(v) - 40 : round(v) + 40, round(u) - 40 : round(u) + 40] = (60, 90, 60)
    seen = unchanged([(covered, VIEW)], known, STONE)[0]
    assert [detection is None for detection in seen] == [False, True, False]


def test_a_place_without_any_pattern_has_no_portrait(known: list[Portrait]) -> None:
    blank = np.full_like(picture(), 200)
    assert portraits(blank, VIEW, 0.0, [known[0].detection], STONE) == [None]
