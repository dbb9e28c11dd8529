from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.report.columns import Column, Table, as_number


def test_a_letter_with_an_index_is_set_as_such():
    assert Column("v_x", "vx").head == "v<sub>x</sub>"
    assert Column("<speed>", "vx").head == "&lt;speed&gt;"


def test_a_number_is_written_in_its_unit_with_its_error():
    row = {"x": 0.12345, "sd": 0.0021, "rank": 2.0, "lost": np.nan}
    assert Column("x", "x", "cm", stderr="sd", factor=100).parts(row) == ("12.35", "0.21")
    assert Column("x", "x", decimals=1).parts(row) == ("0.1", None)
    assert Column("x", "x", digits=2).parts(row) == ("0.12", None)
    assert Column("rank", "rank", kind="word").parts(row) == ("2", None)
    assert Column("lost", "lost", kind="note").parts(row) == ("", None)


def test_a_cell_keeps_the_si_value():
    row = {"x": 0.12345}
    cell = Column("x", "x", "cm", decimals=1, factor=100).cell(row)
    assert cell == '<data value="0.12345">12.3</data>'
    assert Column("who", "who", kind="word").cell({"who": "<A>"}) == "&lt;A&gt;"


@pytest.mark.parametrize(("notes", "shown"), [(["", None], 1), (["", "why"], 2)])
def test_notes_that_say_nothing_are_not_shown(notes, shown):
    columns = (Column("x", "x"), Column("note", "note", kind="note"))
    table = Table("t", "T", "", columns, pd.DataFrame({"x": [1.0, 2.0], "note": notes}))
    assert len(table.head) == shown
    assert [len(row) for row in table.rows] == [shown, shown]


def test_only_finite_numbers_are_numbers():
    assert as_number(np.float64(1.5)) == 1.5
    assert [as_number(cell) for cell in (np.nan, np.inf, None, "1")] == [None] * 4
