from __future__ import annotations

import numpy as np
import pytest

from vision.appearance import any_stone, colour_differences, membership

RED, YELLOW = (50, 50, 205), (60, 215, 235)


def worth(*colours: tuple[int, int, int], white: float = 215.0) -> np.ndarray:
    return membership(np.array([colours], np.uint8), any_stone(white))[0]


def test_worth_of_colours() -> None:
    caps = worth(RED, YELLOW)
    assert caps.min() > 0.9
    assert worth((90, 95, 92)) < -0.9
    assert abs(worth((215, 220, 215))) < 0.1


def test_a_dark_blue_cap_is_one_and_granite_that_red_paint_tinges_is_none() -> None:
    """Colours of stones in dim halls, where white ice has a lightness of 175."""
    assert worth((87, 40, 22), (92, 46, 30), (77, 31, 17), white=175).min() > 0.3
    assert worth((45, 42, 66), (47, 45, 60), white=175).max() < 0.1


def test_lightness_says_little_of_a_colour() -> None:
    colour = np.array([[120.0, 150.0, 90.0]])
    lighter = colour + 40 * np.eye(3)[:2]
    assert colour_differences(colour, lighter)[0] == pytest.approx([40 * 0.1**0.5, 40])
