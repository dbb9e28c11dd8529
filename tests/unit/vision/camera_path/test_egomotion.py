from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.synthetic import render_still, sample_scene, still_camera
from curlshot.vision.camera_path.egomotion import foretold
from curlshot.vision.optics.pose import DOWN, View, rotation_vector
from curlshot.vision.video.picture import Image

PATH = still_camera()
SIZE = PATH.size


def turned(picture: Image, focal: float, turn: np.ndarray, zoom: float) -> Image:
    """What the same camera shows after a turn about its axes, rad, and a zoom."""
    before = np.array([[focal, 0, (SIZE[0] - 1) / 2], [0, focal, (SIZE[1] - 1) / 2], [0, 0, 1]])
    after = before * [[zoom, 1, 1], [1, zoom, 1], [1, 1, 1]]
    warp = after @ cv2.Rodrigues(turn)[0] @ np.linalg.inv(before)
    shown = cv2.warpPerspective(picture, warp, SIZE, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(shown, np.uint8)


@pytest.fixture(scope="module")
def still() -> tuple[Image, View]:
    true = PATH.at(0.0)
    vector = np.append(rotation_vector(true.rotation @ DOWN.T), np.log(true.focal))
    return np.asarray(render_still(sample_scene(), PATH, 0.0), np.uint8), View(vector)


def test_a_shaken_camera_is_told_to_a_few_pixels(still: tuple[Image, View]) -> None:
    picture, view = still
    turns = np.array([[0.01, -0.008, 0.005], [-0.005, 0.01, -0.01], [0.015, 0.005, 0.008]])
    zooms = [1.01, 0.985, 1.02]
    pictures = [
        turned(picture, view.focal, turn, zoom) for turn, zoom in zip(turns, zooms, strict=True)
    ]
    views = foretold(picture, view, pictures)
    assert len(views) == len(turns)
    for found, turn, zoom in zip(views, turns, zooms, strict=True):
        left = found.rotation @ view.rotation.T @ cv2.Rodrigues(turn)[0].T
        away = rotation_vector(left)
        assert np.abs(away[:2]).max() * view.focal < 3.0
        assert abs(away[2]) < 0.004
        assert found.vector[3] - view.vector[3] == pytest.approx(np.log(zoom), abs=0.004)


def test_it_ends_where_another_scene_begins(still: tuple[Image, View]) -> None:
    picture, view = still
    rng = np.random.default_rng(3)
    crowd = rng.integers(0, 256, picture.shape, dtype=np.uint8)
    moved = turned(picture, view.focal, np.array([0.01, 0.0, 0.0]), 1.0)
    assert len(foretold(picture, view, [moved, crowd, moved])) == 1
    assert foretold(np.full_like(picture, 230), view, [moved]) == []


def test_what_moves_as_one_in_a_small_part_of_the_picture_is_not_the_camera(
    still: tuple[Image, View],
) -> None:
    _, view = still
    rng = np.random.default_rng(5)
    marks = np.full((480, 640, 3), 200, np.uint8)
    there = marks.copy()
    places = [(x, y) for x in range(60, 600, 90) for y in range(60, 440, 90)]
    moved = 0
    for x, y in places:
        alike = x < 200  # ten of thirty
        moved += alike
        dx, dy = (6, 3) if alike else rng.integers(-9, 10, 2).tolist()
        cv2.rectangle(marks, (x, y), (x + 24, y + 24), (40, 40, 40), -1)
        cv2.rectangle(there, (x + dx, y + dy), (x + 24 + dx, y + 24 + dy), (40, 40, 40), -1)
    assert moved >= 8 and len(places) == 30
    assert foretold(marks, view, [there]) == []
    assert len(foretold(marks, view, [np.roll(marks, (3, 6), (0, 1))])) == 1
