from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from curlshot.data import osp_write as write
from curlshot.tests.helpers.data.osp_xml import read


@given(st.text(max_size=40))
def test_any_word_comes_back_on_one_line(word: str) -> None:
    back = read(write.thing("A", [write.entry("word", word)])).text("word")
    printable = " ".join("".join(c for c in word if c.isprintable()).split())
    assert back == printable.replace("]]>", "]] >")


@given(st.lists(st.floats(allow_infinity=False), max_size=8))
def test_every_digit_comes_back(values: list[float]) -> None:
    root = read(write.thing("A", [write.numbers("v", np.array(values, float))]))
    np.testing.assert_array_equal(root.thing("v").floats(), values)
