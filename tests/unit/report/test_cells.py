from __future__ import annotations

from curlshot.report.cells import data, data_parts, data_significant, exact
from curlshot.report.numbers import DASH


def test_a_cell_shows_few_digits_and_keeps_all():
    assert data(0.8312345) == '<data value="0.8312345">0.831</data>'
    assert data(0.8312345, 1, factor=100) == '<data value="0.8312345">83.1</data>'
    assert data_significant(0.01093456, 2) == '<data value="0.01093456">0.011</data>'
    assert data(2.0, 0) == '<data value="2">2</data>'


def test_what_is_not_known_is_a_dash():
    assert data(None) == data_significant(None) == DASH
    assert data_parts(None, 0.1) == (DASH, None)


def test_value_and_error_are_rounded_together():
    value, error = data_parts(0.8312345, 0.0123456)
    assert value == '<data value="0.8312345">0.831</data>'
    assert error == '<data value="0.0123456">0.012</data>'
    assert data_parts(0.8312345, None)[1] is None
    both = exact(0.8312345, "0.831", 0.0123456, "0.012")
    assert both == f'<span class="pm">{value} ± {error}</span>'
    assert exact(0.8312345, "0.831", None, None) == value
