"""Tables as people have them: with known truth, read to it or refused in one line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.data.tracker import Imported, read_table

T = np.arange(20) / 25
A = np.column_stack([0.1 + 0.02 * T, -1.6 + 1.5 * T - 0.05 * T**2])
B = np.column_stack([0.5 + 0 * T, 1.2 + 0 * T])


def number(value: float, decimal: str = ".") -> str:
    return f"{value:.4f}".replace(".", decimal)


def rows(
    *columns: np.ndarray, delimiter: str = ",", decimal: str = ".", ends: Sequence[str] = ("", "")
) -> str:
    lines = [delimiter.join(number(v, decimal) for v in row) for row in np.column_stack(columns)]
    return "".join(f"{ends[0]}{line}{ends[1]}\n" for line in lines)


def imported(
    folder: Path, text: str | bytes, fps: float | None = None, name: str = "shot.csv"
) -> Imported:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_table([path], fps=fps)


def is_true(table: Imported, **truth: np.ndarray) -> bool:
    found = table.detections
    assert {*found["stone"]} == {*truth}
    for stone, places in truth.items():
        own = found[found["stone"] == stone]
        kept = np.isfinite(places).all(axis=1)
        assert own["t"].to_numpy() == pytest.approx(T[kept], abs=1e-6)
        assert own[["x", "y"]].to_numpy() == pytest.approx(places[kept], abs=1e-4)
    return True


CM = (T, 100 * A, 100 * B)


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ("t_s,Ax_cm,Ay_cm,Bx_cm,By_cm", "A B"),
        ("t_s,redx_cm,redy_cm,yellowx_cm,yellowy_cm", "red yellow"),
        ("t s,x A cm,y A cm,x B cm,y B cm", "A B"),
        ("t s,red x cm,red y cm,yellow x cm,yellow y cm", "red yellow"),
        ('"t, s","red x, cm","red y, cm","B_x, cm","B_y, cm"', "red B"),
        ("t_(s),A_x_(cm),A_y_(cm),B_x_(cm),B_y_(cm)", "A B"),
        ("时间 (秒),红x (cm),红y (cm),B_x (cm),B_y (cm)", "红 B"),
        ("время (с),x красный (см),y красный (см),x B (см),y B (см)", "красный B"),
        ("Zeit (Sek.),x rot (Zentimeter),y rot (Zentimeter),x B (cm),y B (cm)", "rot B"),
    ],
)
def test_units_are_found_wherever_people_write_them(tmp_path: Path, head: str, names: str) -> None:
    one, two = names.split()
    assert is_true(imported(tmp_path, f"{head}\n{rows(*CM)}"), **{one: A, two: B})


@pytest.mark.parametrize("head", ["t,red_x_cm,red_y_cm,tee_x,tee_y", "t,x1 (cm),y1,x2,y2"])
def test_a_unit_of_some_is_not_taken_for_that_of_all(tmp_path: Path, head: str) -> None:
    with pytest.raises(InputError, match=r"\(cm\) has a length unit and \w+ has none"):
        imported(tmp_path, f"{head}\n{rows(*CM)}")


def test_lengths_without_a_unit_are_metres_beside_metres(tmp_path: Path) -> None:
    table = imported(tmp_path, f"t,red_x_m,red_y_m,tee_x,tee_y\n{rows(T, A, B)}")
    assert is_true(table, red=A, tee=B)


def test_nor_may_one_file_leave_to_others_what_its_unit_is(tmp_path: Path) -> None:
    one, two = tmp_path / "A.csv", tmp_path / "B.csv"
    one.write_text(f"t,x (cm),y (cm)\n{rows(T, 100 * A)}")
    two.write_text(f"t,x,y\n{rows(T, B)}")
    with pytest.raises(InputError, match=r"B.csv: has no length unit, but .*A.csv is in cm"):
        read_table([one, two])
    two.write_text(f"t,x (m),y (m)\n{rows(T, B)}")
    assert is_true(read_table([one, two]), A=A, B=B)


def test_the_only_stone_may_be_called_a_before_its_axis(tmp_path: Path) -> None:
    for head in ("t,A_x,A_y", "t,Ax,Ay", "t (s),A x (m),A y (m)"):
        assert is_true(imported(tmp_path, f"{head}\n{rows(T, A)}"), A=A)
    with pytest.raises(InputError, match="no columns x and y"):
        imported(tmp_path, f"t,ax,ay\n{rows(T, A)}")


def test_rows_may_be_numbered_before_their_times(tmp_path: Path) -> None:
    lines = rows(T, A, B).splitlines()
    text = ",t,A_x,A_y,B_x,B_y\n" + "".join(f"{k},{line}\n" for k, line in enumerate(lines))
    assert is_true(imported(tmp_path, text), A=A, B=B)


def test_an_axis_without_the_other_is_told(tmp_path: Path) -> None:
    table = imported(tmp_path, f"t,xA,yA,xB,index,max\n{rows(T, A, B, T)}")
    assert is_true(table, A=A)
    assert [text.partition(": ")[2] for text in table.warnings] == [
        "xb without the other axis; left out"
    ]


MARKS = "NaN N/A #N/A #NV #DIV/0! #WERT! #VALUE! #REF! -- — ? . ... … n.v. NULL"


@pytest.mark.parametrize("mark", MARKS.split())
def test_marks_of_what_is_missing(tmp_path: Path, mark: str) -> None:
    lines = rows(T, A, B).splitlines()
    for k in (3, 8):
        t, _, _, *others = lines[k].split(",")
        lines[k] = ",".join([t, mark, mark, *others])
    table = imported(tmp_path, "\n".join(["t,A_x,A_y,B_x,B_y", *lines]))
    gone = np.where(np.isin(np.arange(len(T)), (3, 8))[:, None], np.nan, A)
    assert is_true(table, A=gone, B=B)


@pytest.mark.parametrize("blank", ["\u00a0", "\u202f", "\u2009"])
def test_blanks_between_thousands(tmp_path: Path, blank: str) -> None:
    written = [[f"{v:,.2f}".replace(",", blank).replace(".", ",") for v in xy] for xy in 1000 * A]
    lines = [";".join([number(t, ","), *xy]) for t, xy in zip(T, written, strict=True)]
    assert any(blank in line for line in lines)
    table = imported(tmp_path, "\n".join(["t;A_x (mm);A_y (mm)", *lines]))
    assert is_true(table, A=A)


@pytest.mark.parametrize(("thousands", "decimal"), [(",", "."), (".", ",")])
def test_other_marks_between_thousands_are_refused(
    tmp_path: Path, thousands: str, decimal: str
) -> None:
    swap = str.maketrans({",": thousands, ".": decimal})
    written = [[f"{v:,.2f}".translate(swap) for v in xy] for xy in 1000 * A]
    lines = [";".join([number(t, decimal), *xy]) for t, xy in zip(T, written, strict=True)]
    with pytest.raises(InputError, match="both commas and points in numbers"):
        imported(tmp_path, "\n".join(["t;A_x (mm);A_y (mm)", *lines]))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252", "utf-16"])
def test_a_german_spreadsheet(tmp_path: Path, encoding: str) -> None:
    head = "Gruppe 3 – Übung;;;;;\n;;;;;\nZeit [s];x grün [cm];y grün [cm];x B [cm];y B [cm];\n"
    text = head + rows(*CM, delimiter=";", decimal=",", ends=("", ";")) + ";;;;;\n" * 5
    table = imported(tmp_path, text.replace("\n", "\r\n").encode(encoding))
    assert is_true(table, grün=A, B=B)


def test_a_header_of_merged_cells_above_units(tmp_path: Path) -> None:
    head = ";rot;;gelb;\nZeit;x;y;x;y\nSekunden;cm;cm;cm;cm\n"
    text = head + rows(*CM, delimiter=";", decimal=",")
    assert is_true(imported(tmp_path, text), rot=A, gelb=B)


@pytest.mark.parametrize(
    "head",
    [
        "Time,Stone A,,Stone B,\ns,x (cm),y (cm),x (cm),y (cm)\n",
        "Shot 4,,,,\nTime (s),Stone A,,Stone B,\n,x [cm],y [cm],x [cm],y [cm]\n",
        "t,Stone A,Stone A,Stone B,Stone B\n(sec),x,y,x,y\n,cm,cm,cm,cm\n",
    ],
)
def test_stones_and_the_time_above_axes(tmp_path: Path, head: str) -> None:
    table = imported(tmp_path, head + rows(*CM))
    assert is_true(table, **{"Stone A": A, "Stone B": B})


def test_rows_of_a_program_that_numbers_them(tmp_path: Path) -> None:
    lines = [f"{k},412,{row},{k}" for k, row in enumerate(rows(A).splitlines(), 1)]
    table = imported(tmp_path, "\n".join([" ,Area,X,Y,Slice", *lines]), fps=25.0)
    assert is_true(table, shot=A)


def test_what_old_systems_end_a_file_with(tmp_path: Path) -> None:
    assert is_true(imported(tmp_path, f"t,A_x,A_y\n{rows(T, A)}\x1a"), A=A)


def test_digits_and_signs_of_full_width(tmp_path: Path) -> None:
    wide = str.maketrans("0123456789.-", "０１２３４５６７８９．－")
    assert is_true(imported(tmp_path, "t,A_x,A_y\n" + rows(T, A).translate(wide)), A=A)


def test_milliseconds_that_do_not_say_so_are_no_seconds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="40 s apart, and A moves for 760 s without a rest"):
        imported(tmp_path, f"t,A_x,A_y\n{rows(1000 * T + 0.5, A)}")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"t,x_px,y_px\n{rows(T, 640 + 200 * A)}", "no columns x and y"),
        (f"t,x (px),y (px)\n{rows(T, 640 + 200 * A)}", "its length unit is “px”"),
        (f"t,x,y\n{rows(T, 640 + 200 * A)}", "places up to"),
        (f"t,x,y\n{rows(np.repeat(T[::2], 2), A)}", "line 3: time stands still"),
        (f"t,x,y\n{rows(T[::-1], A)}", "line 3: time goes back"),
        (f"Stein,t,x,y\n{rows(np.r_[T, T], np.r_[A, B], ends=('1,', ''))}", "in a column stone"),
        (f"t,x,y\n{rows(T, A)}t,x,y\n{rows(T, B)}", "line 22: “t” is not a number"),
        (f"t,x,y\n{rows(T, A)}mean,0,1\n", "line 22: “mean” is not a number"),
        (f"t,x,y\n{rows(T, A)},0,1\n", "line 22: no time"),
        (f"t,A_x (m),A_y (m),B_x (cm),B_y (cm)\n{rows(T, A, B)}", "columns in cm and m"),
        (f"tA,xA,yA,tB,xB,yB\n{rows(T, A, T + 0.01, B)}", "no time column, t"),
        (f"t,xA,yA,t,xB,yB\n{rows(T, A, T + 0.02, B)}", "two columns of times that differ"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as told:
        imported(tmp_path, text)
    assert "\n" not in str(told.value)


def test_stones_of_other_rates_keep_their_times(tmp_path: Path) -> None:
    fast = np.arange(48) / 60
    (tmp_path / "A.csv").write_text(f"t,x,y\n{rows(T, A)}")
    (tmp_path / "B.csv").write_text(f"t,x,y\n{rows(fast, 0.5 + 0.1 * fast, 1 + 0.2 * fast)}")
    found = read_table([tmp_path / "A.csv", tmp_path / "B.csv"]).detections
    own = found[found["stone"] == "B"]
    assert own["t"].to_numpy() == pytest.approx(fast, abs=1e-4)
    assert own["y"].to_numpy() == pytest.approx(1 + 0.2 * own["t"].to_numpy(), abs=1e-4)


def test_an_archive_that_was_cut_short_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="damaged archive"):
        imported(tmp_path, b"PK\x03\x04\x14\x00" + bytes(90), name="shot.trz")
