from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.columns import (
    clock_column,
    refuse_disorder,
    times_of,
    written_unit,
)
from curlshot.data.delimited import TextTable, read_text_table
from curlshot.data.errors import InputError
from curlshot.data.headers import plain_name
from curlshot.data.units import LENGTH_UNITS


def table(tmp_path: Path, text: str) -> TextTable:
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8")
    return read_text_table(path, lambda cells: "x" in cells)


def read_head(tmp_path: Path, head: str) -> TextTable:
    path = tmp_path / "a.csv"
    path.write_text(f"{head}\n" + ",".join("1" for _ in head.split(",")) + "\n", encoding="utf-8")
    return read_text_table(path, lambda cells: cells[0].startswith("t"))


def times(tmp_path: Path, head: str, cells: list[str], fps: float | None = None):
    read = table(tmp_path, f"{head},x\n" + "".join(f"{cell},0.5\n" for cell in cells))
    return times_of(read, {0: read.numbers([0], 0)[:, 0]}, 0, fps)


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("t (s),x (cm),sd_x (mm)", "cm"),
        ("t (s),sd_x (mm),x", None),
        ("t,x (Yards),y [yd.]", "yd"),
        ("t,x (furlong),y (furlong)", "furlong"),
        ("t,x (red),y (red),x (blue),y (blue)", None),
        ("t,x (cm),y", "cm"),
    ],
)
def test_the_unit_is_that_behind_the_wanted_columns(
    tmp_path: Path, head: str, unit: str | None
) -> None:
    read = read_head(tmp_path, head)
    assert read.names is not None
    plain = [plain_name(name) for name in read.names]
    assert written_unit(read, plain, ["x", "y"], LENGTH_UNITS) == unit


def test_two_units_of_one_table_are_refused(tmp_path: Path) -> None:
    read = read_head(tmp_path, "t,x (cm),y (m)")
    with pytest.raises(InputError, match="columns in cm and m"):
        written_unit(read, ["t", "x", "y"], ["x", "y"], LENGTH_UNITS)


@pytest.mark.parametrize(
    ("head", "cells", "expected"),
    [
        ("t (ms)", ["0", "40", "80"], [0, 0.04, 0.08]),
        ("t (min)", ["0", "0.5", "1"], [0, 30, 60]),
        ("time (hours)", ["0", "0.5", "1"], [0, 1800, 3600]),
        ("time (mins)", ["0", "0.5", "1"], [0, 30, 60]),
    ],
)
def test_other_units_of_time_become_seconds(
    tmp_path: Path, head: str, cells: list[str], expected: list[float]
) -> None:
    found, decimals, warnings = times(tmp_path, head, cells)
    np.testing.assert_allclose(found, expected)
    assert (decimals, warnings) == (None, [])


@pytest.mark.parametrize("head", ["t", "t [min:sec]", "time (hh:mm:ss.000)", "t (min)"])
@pytest.mark.parametrize("hours", ["", "0:", "00:0"])
def test_times_of_minutes_and_seconds_become_seconds(tmp_path: Path, head: str, hours: str) -> None:
    found, decimals, _ = times(tmp_path, head, [f"{hours}0:59.50", f"{hours}1:00.25"])
    np.testing.assert_allclose(found, [59.5, 60.25])
    assert decimals == 2
    assert times(tmp_path, head, ["1:59:59.5", "2:00:00.5"])[0].tolist() == [7199.5, 7200.5]
    whole = [f"{hours}0:0{second}.0" for second in range(3)]
    assert times(tmp_path, head, whole, 25.0)[0].tolist() == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("head", ["t", "t (s)", "t [min:sec]"])
def test_seconds_may_come_before_minutes(tmp_path: Path, head: str) -> None:
    assert times(tmp_path, head, ["59.5", "1:00.5"])[0].tolist() == [59.5, 60.5]


@pytest.mark.parametrize("unit", ["min", "ms", "minutes"])
def test_seconds_in_another_unit_do_not(tmp_path: Path, unit: str) -> None:
    with pytest.raises(InputError, match=f"some times are in {unit[:3]}, others as 0:01.25"):
        times(tmp_path, f"t ({unit})", ["0.5", "1:00.5"])


@pytest.mark.parametrize("unit", ["min:sec", "[min:sec]", "min", "h"])
def test_a_line_of_units_may_say_minutes(tmp_path: Path, unit: str) -> None:
    read = table(tmp_path, f"t,x\n{unit},yd\n0:59.5,1\n1:00.5,2\n")
    assert times_of(read, {0: read.numbers([0], 0)[:, 0]}, 0, None)[0].tolist() == [59.5, 60.5]


@pytest.mark.parametrize("cells", [["0:01:25", "0:01:29"], ["0:00:01:25"], ["0:61.5"], ["1:2:"]])
def test_what_a_time_ends_in_is_not_guessed(tmp_path: Path, cells: list[str]) -> None:
    with pytest.raises(InputError, match=f"a time as “{cells[0]}” .*write seconds"):
        times(tmp_path, "t", cells)


def test_only_times_have_colons(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"“0:01\.5” is not a number in column x"):
        table(tmp_path, "t,x\n0,0:01.5\n").numbers([0, 1], 0)


@pytest.mark.parametrize("unit", ["min:sec", "1/25 s"])
def test_a_unit_that_is_no_word_is_not_taken_for_seconds(tmp_path: Path, unit: str) -> None:
    with pytest.raises(InputError, match=f"time unit is “{unit}”, which is unknown here"):
        times(tmp_path, f"t ({unit})", ["0.5", "1.25"])


def test_a_time_in_no_unit_that_is_known_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="time unit is “fortnight”"):
        times(tmp_path, "t (fortnight)", ["0", "0.5", "1"])


@pytest.mark.parametrize(
    "head", ["Zeit (Sekunden)", "temps [secondes]", "tiempo (segundos)", "t (sec)"]
)
def test_seconds_may_be_in_the_language_of_the_time(tmp_path: Path, head: str) -> None:
    assert times(tmp_path, head, ["0.00", "0.50"])[0].tolist() == [0.0, 0.5]


def test_another_name_of_the_time_is_no_unit(tmp_path: Path) -> None:
    assert times(tmp_path, "time (t)", ["0.00", "0.50"])[0].tolist() == [0.0, 0.5]
    with pytest.raises(InputError, match="whole numbers: frames"):
        times(tmp_path, "time (t)", ["0", "1", "2"])


def test_decimals_tell_how_times_were_printed(tmp_path: Path) -> None:
    assert times(tmp_path, "t", ["0.000", "0.033", "0.067"])[1] == 3
    assert times(tmp_path, "t", ["0", "3.3E-2", "6.7E-2"])[1] is None


def test_whole_numbers_are_frames_if_their_rate_is_given(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="whole numbers: frames"):
        times(tmp_path, "t", ["0", "1", "2"])
    found, _, (warning,) = times(tmp_path, "t", ["0", "1", "2"], fps=50)
    np.testing.assert_allclose(found, [0, 0.02, 0.04])
    assert "read as frames" in warning
    _, _, (warning,) = times(tmp_path, "t", ["0.0", "0.5", "1.2"], fps=50)
    assert "not used" in warning


def test_rows_without_a_time_need_a_rate(tmp_path: Path) -> None:
    read = table(tmp_path, "x,y\n1,2\n3,4\n")
    with pytest.raises(InputError, match=r"there are x, y\); rename it, or .* \(`fps`\)"):
        clock_column(read, ["x", "y"], None)
    for written in ("Zeit (s)", "temps"):
        assert clock_column(read, ["x", plain_name(written)], None) == 1
    assert clock_column(read, ["x", "y"], 25.0) is None
    assert clock_column(read, ["x", "frame"], 25.0) == 1
    assert clock_column(read, ["tid", "frame"], 25.0) == 1, "tid may be a track's number"
    assert clock_column(read, ["x", "time"], None) == 1


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        ([0.0, np.nan, 0.2], "line 3: no time"),
        ([0.0, 0.2, 0.1], "line 4: time goes back"),
        ([0.0, 0.1, 0.1], "line 4: time stands still"),
        ([0.0, 0.1, 1e13], "make no sense"),
    ],
)
def test_disorder_is_refused_with_its_line(tmp_path: Path, cells: list[float], said: str) -> None:
    read = table(tmp_path, "t,x\n" + "0,1\n" * 3)
    with pytest.raises(InputError, match=said):
        refuse_disorder(read, np.array(cells))
