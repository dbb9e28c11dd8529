from __future__ import annotations

import csv
import io
import re

import pytest

from curlshot.data.sheet import HOUSE
from curlshot.report.columns import Column, Table
from curlshot.report.listing import page_tables
from curlshot.report.typeset import html_text, latex_text, write_tables


@pytest.fixture(scope="module")
def made(shot):
    return {t.name: t for t in page_tables(shot.results, shot.tracks, HOUSE)}


def test_cells_keep_all_digits(shot, made):
    text = html_text(made["table_2_measured"])
    for hit in shot.results.collisions:
        for state in (*hit.before.values(), *hit.after.values()):
            for value in (state.x, state.vy, state.sd_vy):
                assert f'value="{value!r}"' in text or value == 0
    assert "v<sub>x</sub>" in text


def test_latex_is_balanced_and_escaped(made):
    for table in made.values():
        text = latex_text(table)
        body = re.sub(r"\\.", "", text.split("\n", 1)[1])
        assert body.count("{") == body.count("}")
        assert body.count("$") % 2 == 0
        lines = text.splitlines()
        rows = lines[lines.index(r"\midrule") + 1 : lines.index(r"\bottomrule")]
        assert len(rows) == len(table.frame)
        assert {row.count(" & ") for row in rows} == {len(table.head) - 1}
        assert text.isascii() or table.name == "hits"
    nasty = Column("100 % _ & #", "key", kind="word")
    assert r"\%" in latex_text(
        Table("x", "a_b", "", (nasty,), made["stones"].frame.assign(key="{"))
    )


def test_files_are_written_in_three_forms(tmp_path, made):
    write_tables(tmp_path / "tables", made.values())
    for name, table in made.items():
        for ending in ("html", "csv", "tex"):
            assert (tmp_path / "tables" / f"{name}.{ending}").is_file()
        text = (tmp_path / "tables" / f"{name}.csv").read_text(encoding="utf-8")
        rows = list(csv.DictReader(io.StringIO(text)))
        assert len(rows) == len(table.frame)
        assert list(rows[0]) == list(table.frame.columns)
