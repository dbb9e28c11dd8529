from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from curlshot.data.text import plain_digits


@given(
    st.floats(-1e6, 1e6),
    st.sampled_from(["0123456789", "٠١٢٣٤٥٦٧٨٩", "۰۱۲۳۴۵۶۷۸۹", "०१२३४५६७८९"]),
)
def test_a_number_survives_its_locale(number: float, digits: str) -> None:
    text = f"{number:.6E}".translate(str.maketrans("0123456789", digits))
    text = text.replace("-", "\N{MINUS SIGN}").replace("E", "×10^").replace("+", "")
    assert float(plain_digits(text)) == float(f"{number:.6E}")
