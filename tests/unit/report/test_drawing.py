from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import SHEET
from curlshot.report.drawing import circle, draw_lines, ice_lines, inside, overlap, text_box, write
from curlshot.vision.optics.camera import Camera

SCALE = 50.0  # px a metre


def camera(homography=None) -> Camera:
    above = np.array([[SCALE, 0, 160], [0, -SCALE, 120], [0, 0, 1]])
    return Camera(0, 0.0, above if homography is None else homography, (320, 240))


def blank() -> np.ndarray:
    return np.full((240, 320, 3), 90, np.uint8)


def test_a_circle_is_closed_and_round():
    points = circle(9)
    assert points.shape == (9, 2)
    np.testing.assert_allclose(points[0], points[-1], atol=1e-12)
    np.testing.assert_allclose(np.hypot(*points.T), 1)


def test_lines_lie_where_the_rulebook_puts_them():
    lines = ice_lines((1.829, 0.61))
    assert len(lines) == 2 + 4
    np.testing.assert_allclose(np.hypot(*lines[1].T), 0.61)
    assert [float(line[0, 1]) for line in lines[2:5]] == [0.0, -SHEET.back_line, SHEET.hog_line]
    assert (lines[5][:, 0] == 0).all()
    up = ice_lines((1.829,), play=1)
    assert [float(line[0, 1]) for line in up[1:4]] == [0.0, SHEET.back_line, -SHEET.hog_line]
    assert up[4][:, 1].max() == SHEET.back_line
    assert ice_lines(()) == []


def test_a_line_is_drawn_where_the_camera_sees_it():
    image = blank()
    draw_lines(image, camera(), [np.array([[-1.0, 0.5], [1.0, 0.5]])], (0, 0, 255), 1, edge=False)
    red = np.argwhere((image[..., 2] > 200) & (image[..., 1] < 60))
    assert set(red[:, 0]) == {120 - 25}
    assert (red[:, 1].min(), red[:, 1].max()) == pytest.approx((160 - 50, 160 + 50), abs=1)


def test_lines_are_not_joined_to_one_another():
    image = blank()
    apart = [np.array([[-2.0, y], [-1.0, y]]) for y in (1.0, -1.0)]
    draw_lines(image, camera(), apart, (0, 0, 255), 1)
    assert (image[100:140] == 90).all()


def test_what_lies_behind_the_camera_is_left_out():
    image = blank()
    tilted = np.array([[SCALE, 0, 160], [0, -SCALE, 120], [0, -0.7, 1]])
    draw_lines(image, camera(tilted), [np.array([[0.0, 2.0], [0.0, 5.0]])], (0, 0, 255), 3)
    assert (image == 90).all()


def test_words_stay_within_their_box():
    image = blank()
    wide, high = text_box("A 1.23 m/s", 1.0)
    write(image, "A 1.23 m/s", (10, 20), 1.0, stripe=(0, 0, 255))
    touched = np.argwhere((image != 90).any(axis=2))
    (top, left), (bottom, right) = touched.min(axis=0), touched.max(axis=0)
    assert (left, top) == (10, 20)
    assert right - left < wide + 1 and bottom - top < high + 1
    assert (image[21, 10] == (0, 0, 255)).all()
    assert (image.max(axis=2) == 255).any()


def test_boxes():
    assert overlap((0, 0, 2, 2), (1, 1, 3, 4)) == pytest.approx(1.0)
    assert overlap((0, 0, 1, 1), (1, 0, 2, 1)) == 0
    assert inside(blank(), (0, 0, 319, 239))
    assert not inside(blank(), (-1, 0, 10, 10))
    assert not inside(blank(), (300, 0, 320, 10))
