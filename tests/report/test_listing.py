from __future__ import annotations

import csv
import io
import re

import pytest

from data.sheet import HOUSE
from report.columns import Column, Table
from report.listing import page_tables
from report.numbers import parts
from report.typeset import html_text, latex_text, write_tables
from report.units import FEET, METRES


@pytest.fixture(scope="module")
def made(shot):
    return {t.name: t for t in page_tables(shot.results, shot.tracks, HOUSE)}


def test_the_tables_of_the_study_and_of_coaches_are_there(made):
    names = list(made)
    assert names[:4] == ["coach_stones", "coach_speeds", "coach_hits", "coach_distances"]
    assert {"table_1_laws", "table_2_measured", "table_4_point-mass"} <= set(names)
    assert {"methods", "laws_tried", "ice"} <= set(names)
    assert "table_3_rigid-body" not in names  # it could not run


def test_without_a_house_there_is_nothing_for_coaches(shot):
    names = [table.name for table in page_tables(shot.results, shot.tracks, None)]
    assert not [name for name in names if name.startswith("coach")]


def test_feet_are_metres_by_another_name(shot, made):
    feet = {t.name: t for t in page_tables(shot.results, shot.tracks, HOUSE, FEET)}
    for name in ("coach_stones", "coach_distances", "coach_hits"):
        assert feet[name].frame.equals(made[name].frame)
        units = {column.unit for column in feet[name].head}
        assert units & {"ft", "ft/s"}
        assert not units & {"m", "m/s"}
    row = feet["coach_distances"].records[0]
    tee = next(c for c in feet["coach_distances"].head if c.key == "tee")
    assert float(tee.parts(row)[0]) == pytest.approx(row["tee"] / 0.3048, abs=0.06)
    assert FEET.length(0.3048) == "1.0 ft"
    assert METRES.length(0.3048) == "0.30 m"


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


def test_empty_notes_take_no_room(made):
    assert "note" not in [column.title for column in made["coach_hits"].head]
    assert "note" in [column.title for column in made["hits"].head]


@pytest.mark.parametrize(
    ("value", "stderr", "most", "said"),
    [
        (1.23456, 0.0123, 4, ("1.235", "0.012")),
        (1.23456, 0.0000123, 3, ("1.235", "0.000")),
        (1e-7, 1.2e-5, 4, ("0", None)),
        (0.0, 0.0, 4, ("0", None)),
        (1.23456, None, 3, ("1.235", None)),
        (None, 0.1, 3, ("—", None)),
    ],
)
def test_decimals_have_an_end(value, stderr, most, said):
    assert parts(value, stderr, most) == said
