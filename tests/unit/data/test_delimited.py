from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.delimited import read_text_table
from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table
from curlshot.tests.helpers.data.delimited import is_header, read


def test_rows_names_title_and_line_numbers(tmp_path: Path) -> None:
    table = read(tmp_path, "#multi:\n\n;red;;\nt;x;y;\n0;1;2\n;;\n\n# note\n1;;4\n")
    assert table.names == ("t", "x", "y")
    assert table.title == ";red;;"
    assert table.delimiter == ";"
    assert table.line_numbers == (5, 9)
    np.testing.assert_array_equal(table.numbers([2, 1]), [[2, 1], [4, np.nan]])
    assert table.cells([1]) == [["1", ""]]


@pytest.mark.parametrize("delimiter", ["\t", ";", ",", " ", "|", " | ", "::", "&"])
def test_delimiters(tmp_path: Path, delimiter: str) -> None:
    rows = [("t", "x", "y"), ("0", "1", "2"), ("1", "3", "4")]
    text = "\n".join(delimiter.join(row) for row in rows)
    np.testing.assert_array_equal(read(tmp_path, text).numbers([0, 1, 2]), [[0, 1, 2], [1, 3, 4]])


def test_words_for_nothing(tmp_path: Path) -> None:
    table = read(tmp_path, "t,x\n0,NaN\n1,#N/A\n2,null\n3,-\n4,\n5\n")
    assert np.isnan(table.numbers([1])).all()


def test_a_row_of_units_joins_the_names(tmp_path: Path) -> None:
    assert read(tmp_path, "t;x\ns;(cm)\n0;1\n").names == ("t (s)", "x (cm)")
    assert read(tmp_path, "t;x\n;\n0;1\n").names == ("t", "x")


@pytest.mark.parametrize(
    "text", ["t / s;x / cm;y / cm", "t/s\tx/cm\ty/cm", "t in s,x in cm,y in cm"]
)
def test_units_behind_a_stroke_or_in_words(tmp_path: Path, text: str) -> None:
    mark = next(mark for mark in "\t;," if mark in text)
    path = tmp_path / "table.txt"
    path.write_text(f"{text}\n" + "".join(f"0.{k}{mark}{k}{mark}200\n" for k in range(5)))
    table = read_text_table(path, lambda names: names[0] == "t (s)")
    assert table.names == ("t (s)", "x (cm)", "y (cm)")
    tracks = read_table([path]).detections
    assert tracks["y"].tolist() == [2.0] * 5
    assert tracks["t"].tolist() == pytest.approx([0, 0.1, 0.2, 0.3, 0.4])


def test_blanks_hide_what_is_missing(tmp_path: Path) -> None:
    # One blank per cell, as Tracker writes, leaves no doubt; runs of blanks do.
    table = read(tmp_path, "t x y \n0  2\n1 3 \n")
    np.testing.assert_array_equal(table.numbers([1, 2]), [[np.nan, 2], [3, np.nan]])
    with pytest.raises(InputError, match="cannot be placed"):
        read(tmp_path, "t  x  y\n0  1  2\n1     2\n").numbers([0, 1, 2])


def test_quoted_cells(tmp_path: Path) -> None:
    table = read(tmp_path, '"t","x"\n"0,5","1,25"\n')
    np.testing.assert_array_equal(table.numbers([0, 1]), [[0.5, 1.25]])


def test_a_giant_file_is_not_even_opened(tmp_path: Path) -> None:
    path = tmp_path / "giant.txt"
    with path.open("wb") as file:
        file.truncate(300_000_000)  # sparse
    with pytest.raises(InputError, match="300 MB is too large"):
        read_text_table(path, is_header)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("t\tx\ty\n" + "0\n" * 1_000_001, "lines are too many"),
        ("t\tx\ty\n" + "1\t" * 600_000 + "\n", "is no row of a table"),
    ],
    ids=["lines", "line"],
)
def test_tables_beyond_all_measure_are_refused(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        read(tmp_path, text)


def test_more_cells_than_memory_should_hold_are_refused(tmp_path: Path) -> None:
    table = read(tmp_path, "t,x\n" + "0,1\n" * 1000)
    with pytest.raises(InputError, match="1000 rows of 4000 numbers are too many"):
        table.numbers([1] * 4000)


@pytest.mark.parametrize("units", ["s;cm;cm", "(s);(cm);(cm);", "[s];[cm];[cm]", ";cm;cm"])
def test_a_row_of_units_below_the_header(tmp_path: Path, units: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"sep=;\nMass A;;;\nt;x;y;\n{units}\n0,04;110;200;\n0,08;112;205;;;\n;;;\n")
    found = read_table([path])
    assert list(found.detections["stone"]) == ["Mass A"] * 2
    np.testing.assert_allclose(found.detections["x"], [1.1, 1.12])
    assert "length unit cm, as the header says" in found.warnings[0]
