from __future__ import annotations

import math

import pytest

from curlshot.data.results import Estimate, Prediction
from curlshot.report.numbers import DASH, MINUS, assumed, fixed, parts, plus_minus, significant


@pytest.mark.parametrize(
    ("value", "stderr", "text"),
    [
        (0.8312345, 0.0123456, "0.831 ± 0.012"),
        (0.01093456, 0.00041234, "0.01093 ± 0.00041"),
        (0.83, 0.0996, "0.83 ± 0.10"),
        (-0.0004, 0.0123, "0.000 ± 0.012"),
        (-1.25, 0.25, f"{MINUS}1.25 ± 0.25"),
        (12345.6, 1234.5, "12300 ± 1200"),
        (0.83449, None, "0.834"),
        (0.83449, 0.0, "0.834"),
        (0.83449, math.nan, "0.834"),
        (None, 0.1, DASH),
        (math.nan, 0.1, DASH),
    ],
)
def test_value_and_error_round_together(value, stderr, text):
    assert plus_minus(value, stderr) == text


def test_numbers_without_an_error():
    assert fixed(-0.0001, 2) == "0.00"
    assert fixed(-1.23456, 2) == f"{MINUS}1.23"
    assert fixed(None) == fixed(math.inf) == significant(None) == DASH
    assert significant(0.0) == "0"
    assert significant(0.000123456) == "0.000123"
    assert significant(29.97, 4) == "29.97"


@pytest.mark.parametrize(
    ("value", "stderr", "most", "said"),
    [
        (1.23456, 0.0123, 4, ("1.235", "0.012")),
        (1.23456, 0.000123, 3, ("1.2346", "0.0001")),
        (1.23456, 0.0000123, 3, ("1.23456", "0.00001")),
        (1.23456, 0.00000123, 3, ("1.235", "0.000")),
        (1e-7, 1.2e-5, 4, ("0", None)),
        (0.0, 0.0, 4, ("0", None)),
        (1.23456, None, 3, ("1.235", None)),
        (None, 0.1, 3, ("—", None)),
    ],
)
def test_decimals_have_an_end(value, stderr, most, said):
    assert parts(value, stderr, most) == said


@pytest.mark.parametrize(
    ("e", "mu", "said"),
    [
        (Estimate(0.83, 0.06), Estimate(0.0109, 0.003), "e = 0.83 assumed"),
        (Estimate(0.9, 0.0), Estimate(0.012, 0.0), "e = 0.9 and μ = 0.012 assumed"),
        (Estimate(), Estimate(), "e assumed"),
    ],
)
def test_what_a_prediction_assumes_is_said_with_its_value(
    e: Estimate, mu: Estimate, said: str
) -> None:
    assert assumed(Prediction(0.1, restitution=e, friction=mu)) == said
