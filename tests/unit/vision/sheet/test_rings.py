from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.tests.helpers.vision.rings import H, W, drawn
from curlshot.vision.sheet.rings import GUESSES, guesses


def test_the_middle_house_comes_before_its_neighbour() -> None:
    both = drawn((200, 95), 55)
    both[:, :120] = drawn((60, 95), 55)[:, :120]
    best = guesses(both)[0]
    np.testing.assert_allclose(best.centre, (200, 95), atol=4)


def test_rings_wider_than_an_upright_picture_are_found() -> None:
    upright = cv2.resize(drawn((160, 70), 99), None, fx=3, fy=3)[:569, 320:640]
    best = guesses(upright)[0]
    np.testing.assert_allclose(best.centre, (160, 211), atol=4)
    assert best.scale * 1.829 == pytest.approx(297, rel=0.06)


def test_a_blank_picture_has_no_rings() -> None:
    assert guesses(np.full((H, W, 3), 128, np.uint8)) == []


@pytest.mark.parametrize("width", [8, 20, 41, 60])
def test_a_tiny_picture_stops_nothing(width: int) -> None:
    tiny = cv2.resize(drawn((160, 90), 70), (width, width), interpolation=cv2.INTER_AREA)
    assert len(guesses(tiny)) <= GUESSES
