from __future__ import annotations

from pathlib import Path

import pytest

from curlshot.tests.helpers.data.reading import read, stones, xy


def test_times_in_milliseconds_and_frames(tmp_path: Path) -> None:
    assert list(read(tmp_path, "t (ms),x,y\n0,1,2\n40,1,2\n").tracks["t"]) == [0, 0.04]
    file = read(tmp_path, "frame,x,y\n10,1,2\n12,1,2\n", fps=50)
    assert list(file.tracks["t"]) == [0.2, 0.24]
    assert list(file.tracks["frame"]) == [10, 12]


def test_the_same_times_twice_are_one_clock(tmp_path: Path) -> None:
    file = read(tmp_path, "t;x;y;t;x;y\n0;1;2;0;3;4\n0,1;1;2;0,1;3;4\n")
    assert stones(file) == ["A", "B"]


def test_decimals_of_the_times(tmp_path: Path) -> None:
    assert read(tmp_path, "t,x,y\n0.000,1,2\n0.033,1,2\n").decimals == 3
    assert read(tmp_path, "t;x;y\n0;1;2\n0,5;1;2\n").decimals == 1
    assert read(tmp_path, "t,x,y\n0.000000E0,1,2\n3.333333E-2,1,2\n").decimals is None


def test_comment_sign_before_the_header(tmp_path: Path) -> None:
    file = read(tmp_path, "# made with numpy\n# t x y\n0.0 1.0 2.0\n0.5 1.0 2.5\n")
    assert xy(file, "shot") == [[1, 2], [1, 2.5]]


@pytest.mark.parametrize("head", ["xB (cm),yB (cm)", "redx (cm),redy (cm)", "B x (cm),B y (cm)"])
def test_a_unit_behind_a_name_of_one_word_counts(tmp_path: Path, head: str) -> None:
    assert read(tmp_path, f"t (s),{head}\n0,1,2\n0.1,2,3\n").length_unit == "cm"
