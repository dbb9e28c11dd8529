from __future__ import annotations

import pytest

from curlshot.data.errors import InputError
from curlshot.data.text import plain_decimals, plain_digits


@pytest.mark.parametrize(
    ("written", "plain"),
    [
        ("−2,641376×10^0", "-2,641376E0"),
        ("3,333333×10^−2", "3,333333E-2"),
        ("1.5 · 10^3", "1.5E3"),
        ("\u200e−۱٫۵", "-1.5"),
        ("؜-٢٫٥أس٣", "-2.5E3"),
        ("१२३", "123"),
        ("-1.5E-3", "-1.5E-3"),
        ("2×10 cm", "2×10 cm"),
        ("a×b", "a×b"),
    ],
)
def test_signs_digits_and_exponents_of_all_locales(written: str, plain: str) -> None:
    assert plain_digits(written) == plain


def test_decimal_commas_are_for_all_columns_or_none() -> None:
    assert plain_decimals([["1,5", ""], ["2", "3"]], "f") == [["1.5", ""], ["2", "3"]]
    assert plain_decimals([["1.5"], ["2"]], "f") == [["1.5"], ["2"]]
    for columns in ([["1,5"], ["1.5"]], [["1.234,5"]], [["1,234.5"]]):
        with pytest.raises(InputError, match="which is the decimal sign"):
            plain_decimals(columns, "f")
