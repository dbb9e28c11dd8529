from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from curlshot.report.numbers import MINUS, parts


@given(
    st.floats(-1e4, 1e4, allow_nan=False),
    st.floats(1e-6, 1e3, allow_nan=False),
)
def test_rounding_stays_within_half_of_the_last_digit(value, stderr):
    first, second = parts(value, stderr)
    assert second is not None
    decimals = len(second.split(".")[1]) if "." in second else 0
    unit = max(10.0**-decimals, 10.0 ** math.floor(math.log10(float(second)) - 1 + 1e-9))
    assert abs(float(first.replace(MINUS, "-")) - value) <= 0.5001 * unit
    assert abs(float(second) - stderr) <= 0.0501 * stderr * 1.0001
    digits = second.replace(".", "").lstrip("0")
    assert len(digits) == 2 or (decimals == 0 and float(second) >= 100)
