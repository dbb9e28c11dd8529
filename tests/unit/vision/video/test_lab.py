from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.vision.video.colour import bgr_of, chroma, lab_of


def test_colours_are_those_of_opencv() -> None:
    steps = np.arange(0, 256, 15, dtype=np.uint8)
    bgr = np.stack(np.meshgrid(steps, steps, steps), -1)
    theirs = cv2.cvtColor(bgr.reshape(len(steps), -1, 3), cv2.COLOR_BGR2LAB).reshape(bgr.shape)
    away = np.abs(lab_of(bgr).astype(int) - theirs)
    assert away.max() <= 2  # theirs are between the nodes of a coarse table
    assert away.mean() < 0.15


@pytest.mark.parametrize(
    ("bgr", "lab"), [((0, 0, 0), (0, 128, 128)), ((255, 255, 255), (255, 128, 128))]
)
def test_black_and_white_have_no_hue(bgr: tuple[int, ...], lab: tuple[int, ...]) -> None:
    assert lab_of(np.array([bgr], np.uint8)).tolist() == [list(lab)]


def test_how_far_colours_are_from_grey() -> None:
    lab = np.array([[[50.0, 128.0, 128.0], [50.0, 131.0, 132.0]], [[250.0, 128.0, 118.0]] * 2])
    np.testing.assert_allclose(chroma(lab), [[0, 5], [10, 10]])


def test_colours_come_back() -> None:
    bgr = np.random.default_rng(1).integers(0, 256, (200, 3)).astype(np.uint8)
    back = np.array([bgr_of(lab) for lab in lab_of(bgr).astype(float)])
    away = np.abs(back - bgr.astype(int))
    assert np.median(away) <= 1
    assert (away.max(1) <= 8).mean() > 0.95  # a step of a* is several of blue in the dark


def test_what_no_screen_shows_is_held_to_what_it_can() -> None:
    assert all(0 <= part <= 255 for part in bgr_of(np.array([128.0, 255.0, 0.0])))
