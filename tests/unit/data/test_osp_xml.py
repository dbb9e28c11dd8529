from __future__ import annotations

import numpy as np
import pytest

from curlshot.data import osp_write as write
from curlshot.data.errors import InputError
from curlshot.data.osp_xml import DEEPEST, parse
from curlshot.tests.helpers.data.osp_xml import read


def test_what_is_written_is_read() -> None:
    inner = write.thing("org.Inner", [write.entry("k", 3)])
    values = np.array([[1.5, np.nan], [-2.25, 1e-300]])
    root = read(
        write.thing(
            "org.opensourcephysics.Outer",
            [
                write.entry("word", 'a "b" <c> & d'),
                write.entry("real", 0.1),
                write.entry("yes", True),
                write.nested("inner", inner),
                write.sparse("frames", "org.Inner", {2: inner, 7: inner}),
                write.strings("words", {1: "x"}),
                write.numbers("values", values),
                write.collection("list", [inner, inner]),
            ],
        )
    )
    assert root.cls == "Outer"
    assert root.text("word") == 'a "b" <c> & d'
    assert root.number("real") == 0.1
    assert root.true("yes") and not root.true("no")
    assert root.thing("inner").whole("k") == 3
    assert sorted(root.thing("frames").sparse()) == [2, 7]
    assert root.thing("words").sparse() == {1: "x"}
    np.testing.assert_array_equal(root.thing("values").floats(), values.ravel())
    assert [item.cls for item in root.thing("list").objects()] == ["Inner", "Inner"]


def test_what_is_missing_has_a_default_or_is_refused() -> None:
    root = read(write.thing("A", [write.entry("word", "x"), write.entry("half", 0.5)]))
    assert root.text("none", "d") == "d"
    assert root.number("none", 2.0) == 2.0
    for name in ("none", "word"):
        with pytest.raises(InputError, match="has no number"):
            root.number(name)
    with pytest.raises(InputError, match="no whole number"):
        root.whole("half")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "damaged"),
        ("<object", "damaged"),
        ("<html></html>", "element “html”"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><object class="A"/>', "entities"),
        ("<property name='a'/>", "element “property”"),
        ("<object class='A'>" + "<property name='a'>" * DEEPEST, "nested too deeply"),
    ],
)
def test_other_xml_is_refused(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        parse(text.encode(), "a.trk")


def test_latin_1_that_calls_itself_utf_8_is_read() -> None:
    raw = b'<?xml version="1.0" encoding="UTF-8"?><object class="A">'
    raw += '<property name="n" type="string">sköld</property></object>'.encode("latin-1")
    assert parse(raw, "a.trk").text("n") == "sköld"
