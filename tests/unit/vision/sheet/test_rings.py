from __future__ import annotations

import cv2
import numpy as np
import pytest

from curlshot.vision.sheet.rings import GUESSES, guesses

W, H = 320, 180


def drawn(
    centre: tuple[float, float], twelve: float, squash: float = 1.0, lean_deg: float = 0.0
) -> np.ndarray:
    """Rings drawn four times as large and shrunk: smooth edges."""
    image = np.full((4 * H, 4 * W, 3), 235, np.uint8)
    middle = (round(4 * centre[0]), round(4 * centre[1]))
    for radius, colour in ((1.829, (60, 40, 190)), (1.213, (235, 235, 235)), (0.62, (150, 90, 20))):
        along = 4 * twelve * radius / 1.829
        cv2.ellipse(
            image, middle, (round(along), round(along * squash)), lean_deg, 0, 360, colour, -1
        )
    return cv2.resize(image, (W, H), interpolation=cv2.INTER_AREA)


@pytest.mark.parametrize("squash", [1.0, 0.78, 0.5])
@pytest.mark.parametrize(
    ("centre", "twelve"), [((160, 90), 60), ((150, 172), 75), ((165, 200), 80)]
)
def test_the_rings_are_the_first_guess(
    centre: tuple[float, float], twelve: float, squash: float
) -> None:
    best = guesses(drawn(centre, twelve, squash))[0]
    np.testing.assert_allclose(best.centre, centre, atol=4)
    assert best.scale * 1.829 == pytest.approx(twelve, rel=0.06)
    assert best.foreshortening == pytest.approx(squash, abs=0.11)


@pytest.mark.parametrize(
    ("squash", "lean"), [(0.55, -20.0), (0.55, 20.0), (0.55, -40.0), (0.46, 28.0), (0.42, 12.0)]
)
def test_rings_that_lean_are_found(squash: float, lean: float) -> None:
    best = guesses(drawn((160, 90), 70, squash, lean))[0]
    assert best.foreshortening == pytest.approx(squash, abs=0.06)
    np.testing.assert_allclose(best.centre, (160, 90), atol=4)
    # OpenCV turns an ellipse clockwise in the picture, its short axis too.
    assert best.lean == pytest.approx(-np.radians(lean), abs=0.2)


def test_the_middle_house_comes_before_its_neighbour() -> None:
    both = drawn((200, 95), 55)
    both[:, :120] = drawn((60, 95), 55)[:, :120]
    best = guesses(both)[0]
    np.testing.assert_allclose(best.centre, (200, 95), atol=4)


@pytest.mark.parametrize("squash", [1.0, 0.6])
def test_rings_are_found_in_upright_pictures(squash: float) -> None:
    upright = np.random.default_rng(2).integers(0, 256, (569, W, 3), np.uint8)
    upright[200:380] = drawn((160, 90), 80, squash)
    best = guesses(upright)[0]
    np.testing.assert_allclose(best.centre, (160, 290), atol=4)
    assert best.foreshortening == pytest.approx(squash, abs=0.11)


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
