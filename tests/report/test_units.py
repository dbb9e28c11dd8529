from __future__ import annotations

import pytest

from report.units import FEET, METRES, UNITS


def test_a_foot_has_twelve_inches():
    assert FEET.small_per_metre / FEET.per_metre == pytest.approx(12)
    assert FEET.length(0.3048) == "1.0 ft"
    assert FEET.little(0.0254) == "1.0 in"
    assert METRES.length(0.3048) == "0.30 m"
    assert METRES.little(0.0254) == "2.5 cm"


def test_units_are_found_by_their_symbols():
    assert UNITS == {"m": METRES, "ft": FEET}
