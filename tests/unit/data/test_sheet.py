from __future__ import annotations

import pytest

from curlshot.data.sheet import HOUSE, SHEET, STONE, curling_size

FOOT, INCH = 0.3048, 0.0254


def test_the_house_is_named_by_its_diameters():
    """Rules of Curling: circles of radius 6, 4 and 2 feet, and 6 inches."""
    assert pytest.approx(6 * FOOT, abs=5e-4) == HOUSE.twelve_foot
    assert pytest.approx(4 * FOOT, abs=5e-4) == HOUSE.eight_foot
    assert pytest.approx(2 * FOOT, abs=5e-4) == HOUSE.four_foot
    assert pytest.approx(6 * INCH, abs=5e-4) == HOUSE.button


def test_lines_lie_as_the_rules_say():
    """Back line 6 ft behind the tee, hog line 21 ft before it, 114 ft from tee to tee."""
    assert pytest.approx(6 * FOOT, abs=5e-4) == SHEET.back_line
    assert pytest.approx(21 * FOOT, abs=5e-4) == SHEET.hog_line
    assert pytest.approx(114 * FOOT, abs=5e-4) == SHEET.far_tee
    assert SHEET.half_width_min < SHEET.half_width < SHEET.half_width_max


def test_a_stone_is_within_the_rules():
    """At most 36 inches around, at least 4.5 inches high, 17.24 to 19.96 kg."""
    assert 2 * 3.14159 * STONE.radius <= 36 * INCH
    assert STONE.cap_height >= 4.5 * INCH
    assert 17.24 <= STONE.mass <= 19.96


@pytest.mark.parametrize(("radius", "stones"), [(0.1455, True), (0.14, True), (0.0382, False)])
def test_pucks_are_no_stones(radius: float, stones: bool):
    assert curling_size(radius) == stones
