from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from curlshot.synthetic.camera import tilted_camera
from curlshot.synthetic.clip import render_still
from curlshot.tests.unit.vision.association.test_follow import detection
from curlshot.tests.unit.vision.detection import test_relief as relief
from curlshot.tests.unit.vision.detection.test_stones import CAMERA, YELLOW, camera_of, scene_of
from curlshot.tests.unit.vision.detection.test_stones import RED as SCARLET
from curlshot.vision.detection import appearance
from curlshot.vision.detection import glance as module
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.detection import Detection, Refusal
from curlshot.vision.detection.glance import glance
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.stones import Findings
from curlshot.vision.optics.camera import Camera

RED, BLUE = np.array([120.0, 190.0, 165.0]), np.array([50.0, 140.0, 92.0])


def stone(x: float, colour: np.ndarray, score: float) -> Detection:
    around = np.zeros((20, 3))
    return detection((x, 0.0), colour, score)._replace(
        cap_samples=around + colour, granite_samples=around + np.array([90.0, 128.0, 128.0])
    )


def seen_twice(
    monkeypatch: pytest.MonkeyPatch,
    first: tuple[Detection, ...],
    known: Findings,
    again: dict[float, float],
    shapes: tuple[Detection, ...] = (),
) -> Findings:
    """What a glance makes of stones found at first, then and by shape, and evidence by their x."""

    def measure(looks: Sequence[Look], appearance: object, disc: object) -> SimpleNamespace:
        evidence = np.array([again.get(x, np.nan) for x in looks[0].places[:, 0].tolist()])
        return SimpleNamespace(ok=np.isfinite(evidence), evidence=evidence)

    monkeypatch.setattr(module, "strangers", lambda views, disc, search: ([Findings(first)], disc))
    monkeypatch.setattr(module, "search_picture", lambda image, camera, appearance, disc: known)
    monkeypatch.setattr(module, "by_shape", lambda look, taken, disc, search: shapes)
    monkeypatch.setattr(module, "measure_discs", measure)
    (found,) = glance([(np.zeros((4, 4, 3), np.uint8), Camera(0, 0.0, np.eye(3), (4, 4)))])
    return found


def test_a_stone_of_another_colour_stays_though_it_convinces_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = (
        stone(0.0, RED, 2.0), stone(0.6, BLUE, 1.2), stone(1.2, RED, 1.1), stone(0.1, BLUE, 1.1),
    )  # fmt: skip
    refused = tuple(Refusal(s.x, s.y, 0.4, "too little resemblance to a stone") for s in first[1:3])
    found = seen_twice(monkeypatch, first, Findings(first[:1], refused), {1.2: 1.2})
    assert [s.x for s in found.stones] == [0.0, 0.6]
    assert [place.x for place in found.refused] == [1.2]  # what is taken is not refused too


def test_what_is_passed_over_stays_if_both_measures_together_show_enough(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    places = (0.0, 0.5, 1.0, 1.5, -0.5)
    scores, again = (2.0, 2.0, 1.45, 1.1, 1.9), (2.0, 2.0, 1.0, 1.2, 0.4)
    colours = (RED, BLUE, RED, BLUE, RED)
    first = tuple(map(stone, places, colours, scores))
    evidence = dict(zip(places, again, strict=True))
    found = seen_twice(monkeypatch, first, Findings(first[:2]), evidence)
    assert [s.x for s in found.stones] == [0.0, 0.5, 1.0]


def test_shapes_that_colours_miss_stay_if_they_convince_and_colours_do_not_speak_against_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = (stone(0.0, RED, 2.0), stone(0.5, BLUE, 2.0))
    scores = {1.0: 2.0, 1.5: 1.5, -0.5: 1.2, 0.55: 2.0, -1.0: 1.5}
    *shapes, ice = (stone(x, RED, score) for x, score in scores.items())
    shapes.append(ice._replace(granite_samples=ice.granite_samples + 60.0))
    evidence = {1.0: 0.8, 1.5: 0.8, -0.5: 2.0, 0.55: 2.0, -1.0: 2.0}
    found = seen_twice(monkeypatch, first, Findings(first), evidence, tuple(shapes))
    assert [s.x for s in found.stones] == [0.0, 0.5, 1.0]


def test_a_square_of_a_painted_pattern_is_no_stone_beside_stones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with_handle, without = (relief.seen(height).spectrum for height in (30.0, 0.0))
    first = (
        stone(0.0, RED, 2.0)._replace(spectrum=with_handle, pixel_size=0.005),
        stone(0.6, BLUE, 2.4)._replace(spectrum=without, pixel_size=0.005),
    )
    learned: list[int] = []

    def learn(detections: Sequence[Detection]) -> Appearance | None:
        look = appearance.learn(detections)
        assert look is not None
        learned.append(len(look.caps))
        return look

    monkeypatch.setattr(module, "learn", learn)
    found = seen_twice(monkeypatch, first, Findings(first), {0.6: 2.4})
    assert learned == [1]
    assert [s.x for s in found.stones] == [0.0]
    assert [(place.x, place.reason) for place in found.refused] == [(0.6, "no handle on it")]


@pytest.mark.parametrize("share", [1.0, 0.4, 0.2])
def test_stones_are_found_in_dim_pictures_as_in_bright_ones(share: float) -> None:
    places = [(0.3, 0.2), (-0.8, 1.0), (0.9, -0.6), (-0.2, -1.4)]
    scene = scene_of(
        [(*place, colour) for place, colour in zip(places, [SCARLET, YELLOW] * 2, strict=True)]
    )
    picture = np.asarray(render_still(scene, CAMERA) * share, np.uint8)
    (found,) = glance([(picture, camera_of(CAMERA, scene))])
    seen = np.array([(stone.x, stone.y) for stone in found.stones])
    assert len(seen) == len(places)
    np.testing.assert_allclose(
        seen[np.lexsort(seen.T)], sorted(places, key=lambda p: p[::-1]), atol=0.004
    )


def test_red_caps_of_a_recording_whose_tones_are_linear_are_found() -> None:
    """Dark red ones beside granite that is nearly black: one of three was not."""
    red = (30, 20, 130)
    places = [(0.3, 0.2, red), (-0.8, 1.0, YELLOW), (0.2, -1.5, red), (-1.5, 0.2, red)]
    scene, path = scene_of(places), tilted_camera(np.radians(45), height=5.5, px_per_m=100.0)
    image = np.asarray(render_still(scene, path, supersample=2), np.uint8)
    dark = np.round(255 * (image / 255) ** 2.2).astype(np.uint8)
    coded = cv2.imdecode(cv2.imencode(".jpg", dark, [cv2.IMWRITE_JPEG_QUALITY, 90])[1], 1)
    (found,) = glance([(np.asarray(coded, np.uint8), camera_of(path, scene))])
    assert len(found.stones) == len(places)


def test_tones_of_a_picture_stay_where_no_stone_shows_once_they_are_lifted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = scene_of([(0.3, 0.2, SCARLET), (-0.8, 1.0, YELLOW)])
    image = np.asarray(render_still(scene, CAMERA), np.uint8)
    black = np.zeros(256, np.uint8)
    monkeypatch.setattr("curlshot.vision.detection.glance.tones", lambda *_: black)
    (found,) = glance([(image, camera_of(CAMERA, scene))])
    assert len(found.stones) == 2
