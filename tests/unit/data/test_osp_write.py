from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.osp_write import array, entry, numbers


@pytest.mark.parametrize(
    ("value", "kind", "text"),
    [(True, "boolean", "true"), (3, "int", "3"), (0.1, "double", "0.1"), ("a", "string", "a")],
)
def test_a_value_is_written_with_javas_name_of_its_kind(value, kind: str, text: str) -> None:
    assert entry("n", value) == [f'<property name="n" type="{kind}">{text}</property>']


def test_marks_of_xml_are_kept_from_the_parser() -> None:
    (line,) = entry("n", "a ]]> <b>\n&")
    assert "<![CDATA[a ]] > <b>&]]>" in line


def test_an_array_has_a_bracket_for_each_dimension() -> None:
    assert 'class="[D"' in numbers("v", np.zeros(2))[0]
    head, body, _ = numbers("v", np.array([[1.0, np.nan]]))
    assert 'class="[[D"' in head
    assert "{{1.0,NaN}}" in body
    assert array("v", "[I", ["x"])[1:] == ["x", "</property>"]
