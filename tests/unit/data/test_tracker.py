from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.export import write_csv
from curlshot.data.tracker import read_table
from curlshot.data.tracks import teams, write_tracks
from curlshot.tests.helpers.data.dialects import RED, export, put, truth
from curlshot.tests.helpers.data.tracker import assert_same, read


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
def test_a_letter_with_a_zero_of_its_own_is_text(tmp_path: Path, encoding: str) -> None:
    text = "t,一_x,一_y\n0.0,1.5,2.5\n0.5,2.5,3.5\n"
    assert list(read(tmp_path, text.encode(encoding)).detections["stone"]) == ["一", "一"]


def test_native_digits(tmp_path: Path) -> None:
    digits = str.maketrans("0123456789", "۰۱۲۳۴۵۶۷۸۹")
    header, body = export(truth(), ";", "full", ",", columns=("x", "y")).split("y;\n", 1)
    text = header + "y;\n" + body.translate(digits).replace("-", "\u200e\N{MINUS SIGN}")
    assert_same(read(tmp_path, text).detections, truth(), 5.1e-7)


def test_legacy_layout_and_table_copy_give_the_same_track(tmp_path: Path) -> None:
    rows = [(0.0, -2.641, -1.159), (1 / 30, -2.417, -1.027), (0.1, -1.981, -0.767)]
    body = "".join(f"{t:.9E}\t{x}\t{y}\t\t\n" for t, x, y in rows)
    legacy = read(tmp_path, "mass_A\nt\tx\ty\tv_{x}\tθ_{r}\n" + body)
    copied = read(tmp_path, "\tmass_A\nt\tx\ty\tvx\tθr (°)\n" + body)
    pd.testing.assert_frame_equal(legacy.detections, copied.detections)
    assert list(legacy.detections["stone"]) == ["mass_A"] * 3
    assert list(legacy.detections["frame"]) == [0, 1, 3]
    np.testing.assert_allclose(legacy.detections["x"], [x for _, x, _ in rows], atol=1e-12)


@pytest.mark.parametrize("fps", [23.976, 25.0, 29.97, 50.0, 59.94, 120.0])
def test_times_printed_to_the_millisecond_become_equal_steps(tmp_path: Path, fps: float) -> None:
    n = 150
    table = truth(n, fps)
    found = read(tmp_path, export(table, pattern="four digits", columns=("x", "y")))
    assert found.fps == pytest.approx(fps, rel=2e-4)
    red = found.detections[found.detections["stone"] == RED]
    np.testing.assert_allclose(red["t"], np.arange(n) / fps, atol=4e-4)
    # Differences of printed times would be 0.5 ms wrong.
    assert np.ptp(np.diff(red["t"])) < 1e-9


def test_uneven_times_stay_as_they_are(tmp_path: Path) -> None:
    t = [0.0, 0.033, 0.1, 0.117, 0.2, 0.31]
    found = read(tmp_path, "t\tx\ty\n" + "".join(f"{v}\t{v}\t0\n" for v in t))
    assert list(found.detections["t"]) == t
    assert list(found.detections["frame"]) == list(range(6))


def test_one_file_per_stone_on_one_clock(tmp_path: Path) -> None:
    table = truth()
    paths = [
        put(tmp_path, export(rows, pattern="four digits", columns=("x", "y")), f"{stone}.txt")
        for stone, rows in table.groupby("stone")
    ]
    assert_same(read_table(paths).detections, table, 5.1e-4)
    assert_same(read_table(paths).detections, table, 5.1e-4)
    with pytest.raises(InputError, match="two stones with one name, red stone"):
        read_table([paths[0], paths[0]])


def test_tracks_of_one_name_are_named_after_their_files(tmp_path: Path) -> None:
    """Who marks one stone per project has a mass A in each."""
    rows = "mass_A\nt\tx\ty\n0.00\t{0}\t2\n0.04\t{0}.1\t2\n"
    paths = [put(tmp_path, rows.format(k), f"{name}.txt") for k, name in enumerate("ABC")]
    found = read_table(paths)
    assert list(found.detections["stone"]) == ["A", "A", "B", "B", "C", "C"]
    assert "all their tracks are named mass_A; named after the files" in found.warnings[0]
    chosen = read_table(paths, names={"red": "B"}).detections
    assert list(chosen["x"]) == [1.0, 1.1]
    (tmp_path / "again").mkdir()
    with pytest.raises(InputError, match="two stones with one name, mass_A"):
        read_table([*paths, put(tmp_path / "again", rows.format(5), "A.txt")])


def test_nameless_file_is_named_after_itself(tmp_path: Path) -> None:
    path = put(tmp_path, "t,y,x\n0,1,2\n0.1,1,2.5\n", "Stein Ä.csv")
    found = read_table([path]).detections
    assert list(found["stone"]) == ["Stein Ä"] * 2
    assert list(found["x"]) == [2.0, 2.5]


def test_tidy_table_in_any_order_keeps_spin_and_uncertainty(tmp_path: Path) -> None:
    text = (
        "seen;theta;y;x;sd_x;stone;t\n"
        "1;90,5;1;2;0,01;A;0,04\n0;9;9;9;0,01;A;0,08\n1;;3;4;;B;0,04\n1;97,5;1;2,1;0,01;A;0,12\n"
    )
    found = read(tmp_path, text).detections
    assert list(found["stone"]) == ["A", "A", "B"]
    assert list(found["t"]) == [0.04, 0.12, 0.04]
    # Our own angles run on: neither wrapped nor degrees, whatever they begin with.
    assert list(found["theta"][:2]) == [90.5, 97.5]
    assert list(found["sd_x"][:2]) == [0.01, 0.01]
    assert found["theta"].isna()[2]


def test_own_tracks_come_back(tmp_path: Path) -> None:
    table = truth().assign(theta=0.3, vx=0.0, vy=0.0, omega=0.0, seen=1, team="")
    table = table.assign(**{f"sd_{n}": 0.01 for n in ("x", "y", "theta", "vx", "vy", "omega")})
    write_tracks(table, tmp_path / "tracks.csv")
    found = read_table([tmp_path / "tracks.csv"])
    assert_same(found.detections, truth(), 1e-8)
    assert (found.detections["sd_y"] == 0.01).all()
    assert found.warnings == ()


@pytest.mark.parametrize(("unit", "metres"), [("cm", 0.01), ("mm", 0.001), ("in", 0.0254)])
def test_length_unit(tmp_path: Path, unit: str, metres: float) -> None:
    text = "t,x,y\n0.00,10,-20\n0.04,14,-20\n"
    asked = read(tmp_path, text, length_unit=unit).detections
    np.testing.assert_allclose(asked["x"], np.array([10, 14]) * metres)
    told = read(tmp_path, text.replace("x,y", f"x ({unit}),y ({unit})"))
    pd.testing.assert_frame_equal(told.detections, asked)
    assert unit in told.warnings[0]
    second_row = read(tmp_path, text.replace("x,y\n", f"x,y\ns,{unit},{unit}\n"))
    pd.testing.assert_frame_equal(second_row.detections, asked)


def test_wide_table_without_time_needs_the_rate(tmp_path: Path) -> None:
    text = "c_a_x,c_a_y,ang_a,c_b_x,c_b_y,ang_b\n" + "".join(
        f"{0.1 * k},0,{(3 + 0.1 * k) % 6.283185307},1,{0.2 * k},{-0.1 * k}\n" for k in range(60)
    )
    with pytest.raises(InputError, match="no time column"):
        read(tmp_path, text)
    found = read(tmp_path, text, fps=10).detections
    a = found[found["stone"] == "a"]
    np.testing.assert_allclose(a["t"], np.arange(60) / 10)
    np.testing.assert_allclose(a["theta"], 3 + 0.1 * np.arange(60), atol=1e-6)
    assert list(found["stone"].unique()) == ["a", "b"]


def test_whole_numbers_as_time_are_frames_or_refused(tmp_path: Path) -> None:
    text = "t,x,y\n1,0,0\n2,0.1,0\n4,0.3,0\n"
    frames = read(tmp_path, text, fps=25)
    assert list(frames.detections["t"]) == [0.04, 0.08, 0.16]
    assert "read as frames" in frames.warnings[0]
    with pytest.raises(InputError, match=r"whole numbers: frames\? give their rate"):
        read(tmp_path, text)
    seconds = "t,x,y\n1.000,0,0\n2.000,0.1,0\n4.000,0.3,0\n"
    assert list(read(tmp_path, seconds).detections["t"]) == [1, 2, 4]
    ms = read(tmp_path, "t (ms),x,y\n40,0,0\n80,0.1,0\n160,0.3,0\n")
    np.testing.assert_allclose(ms.detections["t"], [0.04, 0.08, 0.16])


def test_angles_about_the_origin_are_no_spin(tmp_path: Path) -> None:
    t = np.arange(30) / 30
    x, y = 1 - 2 * t, 0.5 + t
    about = np.arctan2(y, x)
    greek = pd.DataFrame({"t": t, "x": x, "y": y, "θ": about, "ω": 1.0})
    assert read(tmp_path, greek.to_csv(index=False)).detections["theta"].isna().all()
    latin = read(tmp_path, greek.rename(columns={"θ": "theta"}).to_csv(index=False))
    assert latin.detections["theta"].isna().all()
    assert "about the origin" in latin.warnings[0]
    spin = greek.rename(columns={"θ": "theta"}).assign(theta=1.5 * t)
    own = read(tmp_path, spin.to_csv(index=False)).detections
    np.testing.assert_allclose(own["theta"], 1.5 * t)


def test_degrees_by_evidence_or_by_word(tmp_path: Path) -> None:
    t = np.arange(100) / 30
    table = pd.DataFrame({"t": t, "x": 1.0 + t, "y": 0.0, "theta": 90 + 70 * t})
    wrapped = table.assign(theta=table["theta"] % 360)
    for source in (table, wrapped):
        found = read(tmp_path, source.to_csv(index=False))
        np.testing.assert_allclose(found.detections["theta"], np.radians(90 + 70 * t))
        assert "degrees" in found.warnings[0]
    rows = table.assign(stone="A", theta=table["theta"] - 90)  # that begin at 0 say nothing
    found = read(tmp_path, rows.to_csv(index=False))
    np.testing.assert_allclose(found.detections["theta"], np.radians(70 * t))
    assert "degrees" in found.warnings[0]
    far = table.assign(stone="A", theta=90 + 2 * t)  # continuous: after many turns
    found = read(tmp_path, far.to_csv(index=False))
    np.testing.assert_allclose(found.detections["theta"], 90 + 2 * t)
    slow = table.assign(theta=2 * t)
    text = slow.to_csv(index=False)
    np.testing.assert_allclose(read(tmp_path, text).detections["theta"], 2 * t)
    told = read(tmp_path, text, angle_unit="deg")
    np.testing.assert_allclose(told.detections["theta"], np.radians(2 * t))
    assert told.warnings == ()


def test_headerless_velocities_are_no_second_stone(tmp_path: Path) -> None:
    t = np.arange(40) / 30
    x, y = 2 * t, np.sin(3 * t)
    rows = np.column_stack([t, x, y, np.full(40, 2.0), 3 * np.cos(3 * t)])
    text = "\n".join("\t".join(f"{v:.6f}" for v in row) for row in rows)
    found = read(tmp_path, text)
    assert list(found.detections["stone"].unique()) == ["shot"]
    assert "velocities" in found.warnings[0]
    rows[:, 3:] += 0.5  # now they are the places of another stone
    text = "\n".join("\t".join(f"{v:.6f}" for v in row) for row in rows)
    assert list(read(tmp_path, text).detections["stone"].unique()) == ["A", "B"]


NONSENSE = {
    "": "empty",
    "\n \n": "empty",
    "hello\nworld\n": "no header",
    "x\n1\n2\n": "only one column",
    "1\n2\n3\n": "only one column",
    "t,x,y\n": "without rows",
    "t,x,y\n0,nan,nan\n1,,\n": "no row with a place",
    "t,x,y\n0,1,1\n1,1,1\n0.5,1,1\n": "line 4: time goes back",
    "t,x,y\n0,1,1\n0,1,1\n": "line 3: time stands still",
    "t,x,y\n0,1,1\n,1,1\n": "line 3: no time",
    "t,x,y\n0,inf,1\n0.1,2,2\n": "infinite",
    "t,x,y\n0,1e999,1\n0.1,2,2\n": "infinite",
    "t,x,y\n0,one,1\n": "line 2: “one” is not a number in column x",
    "t,x,y\n0,1_0,1\n": "not a number",
    "t;x;y\n0.1;1,5;2\n": "both commas and points",
    "t,x,y\n0,1,2,3,4\n": "does not fit the header",
    "t;x;y\n0;1;2;3\n": "has 4 cells",
    "t x y\n0.0  1.0  1.0\n0.1      2.0\n": "cannot be placed",
    "t,x,y\n0,0,0\n0.1,5,1\n0.2,10,1\n0.3,15,2\n": "51 m/s at t = 0.2 s: .*length unit",
    "t,x,y\n0,0,200\n60,1,200\n": "200 m from the origin: .*length unit",
    "t,x\n0,1\n": "columns x: 1, columns y: 0",
    "t,x,x,y\n0,1,1,1\n": "columns x: 2",
    "t,x,y,t,x,y\n0,1,1,0.5,2,2\n": "two columns of times that differ",
    "t,θr,ω\n0,1,2\n": "only angles about the origin",
    "t,vx,vy,ax,ay\n0,1,2,3,4\n": "no columns x and y",
    "0 1 2 3\n1 1 2 3\n": "4 columns without a header",
    "#multi:\n\tr\t\tr\t\t\nt\tx\ty\tx\ty\t\n0\t1\t1\t2\t2\n": "two stones with one name, r",
    "stone,t,x,y\nA,0,1,1\nA,1,1,1\nA,0,2,2\n": "stone A: time goes back",
    "stone,t,x,y\nA,0,1,1\nA,0,2,2\n": "stone A: two rows",
    "stone,t,x,y\n,0,1,1\n": "line 2: no name",
    "stone,t,x\nA,0,1\n": "no",
    "stone,x,y\nA,0,1\n": "no column t",
    "stone,t,x,y,frame\nA,0,1,1,0.5\n": "no frames",
    "stone,t,x,y,sd_x\nA,0,1,1,-1\n": "negative",
    "<?xml version='1.0'?><object/>": "no Tracker project",
    "PK\x03\x04": "damaged",
    "a\0b": "not text",
    "a\0b\0\0\0": "not text",
}


@pytest.mark.parametrize("text", NONSENSE)
def test_nonsense_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match=NONSENSE[text]) as refusal:
        read(tmp_path, text)
    assert "\n" not in str(refusal.value)
    assert str(tmp_path) in str(refusal.value)


def test_missing_file_folder_and_bad_options(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_table([tmp_path / "none.txt"])
    with pytest.raises(InputError, match="a folder"):
        read_table([tmp_path])
    with pytest.raises(InputError, match="no table"):
        read_table([])
    text = "t,x,y\n0,1,1\n"
    for options, reason in [
        ({"length_unit": "ell"}, "length unit"),
        ({"angle_unit": "grad"}, "angle unit"),
        ({"fps": 0.0}, "frame rate"),
        ({"fps": float("nan")}, "frame rate"),
    ]:
        with pytest.raises(InputError, match=reason):
            read(tmp_path, text, **options)


def test_a_stone_without_any_place_is_said_to_be_left_out(tmp_path: Path) -> None:
    text = "stone,t,x,y\n" + "".join(f"A,{k / 10},0,{k / 10}\nB,{k / 10},,1\n" for k in range(9))
    found = read(tmp_path, text)
    assert {*found.detections["stone"]} == {"A"}
    assert any("B has no place in any row; left out" in text for text in found.warnings)


def test_what_does_not_move_is_warned_about(tmp_path: Path) -> None:
    found = read(tmp_path, "t,x,y\n0.0,1,1\n0.1,1.0002,1\n")
    assert "within 0.2 mm" in found.warnings[0]


def test_times_that_must_be_milliseconds_are_told(tmp_path: Path) -> None:
    text = "stone,t,x,y\n" + "".join(f"A,{40 * k + 0.5},0.0,{0.05 * k}\n" for k in range(20))
    with pytest.raises(InputError, match="rows are 40 s apart, and A moves for 760 s without a"):
        read(tmp_path, text)
    seldom = "stone,t,x,y\n" + "".join(f"A,{40 * k + 0.5},0.0,{k // 5}\n" for k in range(20))
    (warning,) = read(tmp_path, seldom).warnings
    assert "rows are 40 s apart" in warning
    by_hand = "stone,t,x,y\n" + "".join(
        f"A,{2 * k + 0.5},0.0,{0.003 * (k % 2)}\nB,{2 * k + 0.5},1.0,{k // 5}\n" for k in range(60)
    )
    (warning,) = read(tmp_path, by_hand).warnings
    assert "rows are 2 s apart" in warning
    right = read(tmp_path, text.replace(",t,", ",t (ms),"))
    assert right.fps == pytest.approx(25.0)
    assert not right.warnings


def test_one_picture_has_places_and_no_rate(tmp_path: Path) -> None:
    found = read(tmp_path, "stone,t,x,y\nA,0,1,1\nB,0,0,1\nC,0,0,2\n")
    assert found.fps is None
    assert found.warnings == ()
    assert list(found.detections["frame"]) == [0, 0, 0]


def test_the_team_of_a_table_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "teams.csv"
    path.write_text(
        "stone,t,x,y,team\n"
        + "".join(
            f"{stone},{k / 25},{x},{0.1 * k},{team}\n"
            for stone, x, team in (("A", 0.0, "Norway"), ("B", 1.0, '"Great Britain"'))
            for k in range(5)
        )
    )
    found = read_table([path]).detections
    assert teams(found) == {"A": "Norway", "B": "Great Britain"}
    copy = tmp_path / "copy.csv"
    write_csv(found, copy)
    assert teams(read_table([copy]).detections) == teams(found)
