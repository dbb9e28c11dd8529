from __future__ import annotations

import pytest

from curlshot.data.coach_units import FEET, METRES, UNITS


def test_a_foot_has_twelve_inches():
    assert FEET.small_per_metre / FEET.per_metre == pytest.approx(12)
    assert FEET.length(0.3048) == "1.0 ft"
    assert FEET.little(0.0254) == "1.0 in"
    assert METRES.length(0.3048) == "0.30 m"
    assert METRES.little(0.0254) == "2.5 cm"


def test_less_than_a_centimetre_is_in_millimetres():
    assert METRES.little(0.01) == "1.0 cm"
    assert METRES.little(0.00996) == "1.0 cm"
    assert METRES.little(0.00994) == "9.9 mm"
    assert METRES.little(0.0) == "0.0 mm"
    assert METRES.little(0.004, beside=0.02) == "0.4 cm"
    assert FEET.little(0.00254) == "0.10 in"
    assert FEET.little(0.0005) == "0.02 in"


def test_units_are_found_by_their_symbols():
    assert UNITS == {"m": METRES, "ft": FEET}


def test_a_text_is_told_in_feet() -> None:
    text = "first seen 3.9 m past it at 0.48 m/s, 3 mm off after 2.0 s, 10 more"
    assert (
        FEET.converted(text)
        == "first seen 12.8 ft past it at 1.57 ft/s, 3 mm off after 2.0 s, 10 more"
    )
    assert METRES.converted(text) == text
