from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.tests.helpers.data.reading import read, stones, xy


@pytest.mark.parametrize(
    ("columns", "names"),
    [
        ("x1,y1,x2,y2", ["1", "2"]),
        ("1x,1y,2x,2y", ["1", "2"]),
        ("red_x,red_y,yellow_x,yellow_y", ["red", "yellow"]),
        ("x red,y red,x yellow,y yellow", ["red", "yellow"]),
        ("c_a_x,c_a_y,c_b_x,c_b_y", ["a", "b"]),
        ("ax,ay,bx,by", ["a", "b"]),
        ("XA,YA,XB,YB", ["A", "B"]),
        ("xO,yO,xP,yP", ["O", "P"]),
    ],
)
def test_pairs_of_columns_are_stones(tmp_path: Path, columns: str, names: list[str]) -> None:
    file = read(tmp_path, f"t,{columns}\n0,1,2,3,4\n1,1,2,3,5\n")
    assert stones(file) == names
    assert xy(file, names[0]) == [[1, 2], [1, 2]]
    assert xy(file, names[1]) == [[3, 4], [3, 5]]


@pytest.mark.parametrize("columns", ["xA,yA,vx,vy", "xA (m),yA (m),ax,ay"])
def test_the_only_stone_may_be_called_a(tmp_path: Path, columns: str) -> None:
    file = read(tmp_path, f"t,{columns}\n0,1,2,3,4\n1,1,2,3,5\n")
    assert stones(file) == ["A"]
    assert xy(file, "A") == [[1, 2], [1, 2]]


@pytest.mark.parametrize("columns", ["vx,vy", "ax,ay", "vx,vy,ax,ay", "px,py", "pixelx,pixely"])
def test_derived_columns_are_no_stones(tmp_path: Path, columns: str) -> None:
    with pytest.raises(InputError, match="no columns x and y"):
        read(tmp_path, f"t,{columns}\n0,1,2,3,4\n")


@pytest.mark.parametrize("columns", ["vx,vy,ax,ay", "ax,ay"])
def test_nor_do_they_stand_beside_one(tmp_path: Path, columns: str) -> None:
    file = read(tmp_path, f"t,x,y,{columns}\n0,1,2{',9' * (columns.count(',') + 1)}\n")
    assert stones(file) == ["shot"]
    assert not file.warnings


@pytest.mark.parametrize(
    "columns", ["b_pos_x,b_pos_y,c_pos_x,c_pos_y", "x_cm_b,y_cm_b,x_cm_c,y_cm_c"]
)
def test_a_stone_c_is_no_centre(tmp_path: Path, columns: str) -> None:
    assert stones(read(tmp_path, f"t,{columns}\n0,1,2,3,4\n1,1,2,3,5\n")) == ["b", "c"]


def test_velocities_alone_are_no_places(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no columns x and y"):
        read(tmp_path, "t,red_velocity_x,red_velocity_y\n0,1,2\n")


def test_what_has_velocities_is_a_stone(tmp_path: Path) -> None:
    assert stones(read(tmp_path, "t,A_x,A_y,A_vx,A_vy\n0,1,2,3,4\n1,1,2,3,5\n")) == ["A"]


def test_times_of_each_stone_may_be_minutes_and_seconds(tmp_path: Path) -> None:
    file = read(tmp_path, "t,x,y,t,x,y\n0:59.5,1,1,0:59.5,2,2\n1:00.5,1,1,1:00.5,2,2\n")
    assert file.tracks["t"].tolist() == [59.5, 60.5] * 2


@pytest.mark.parametrize(
    "columns",
    [
        "red_x,red_y,red_vx,red_vy",
        "x_red,y_red,x_v_red,y_v_red",
        "redx,redy,ax,ay",
        "red_pos_x,red_pos_y,red_vel_x,red_vel_y",
        "red_position_x,red_position_y,red_v_x,red_v_y",
        "pos_red_x,pos_red_y,vel_red_x,vel_red_y",
    ],
)
def test_nor_are_those_of_stones(tmp_path: Path, columns: str) -> None:
    assert stones(read(tmp_path, f"t,{columns}\n0,1,2,3,4\n1,1,2,3,5\n")) == ["red"]


@pytest.mark.parametrize("row", ["0.1,1,2,3", "1,2,3,4", "0.1,1,,3"])
def test_a_row_that_a_missing_cell_has_shifted_is_refused(tmp_path: Path, row: str) -> None:
    with pytest.raises(InputError, match="line 3 has 4 cells, but there are 5 columns"):
        read(tmp_path, f"t,x1,y1,x2,y2\n0,1,2,3,4\n{row}\n0.2,1,2,3,5\n")


def test_one_is_refused_without_a_header_too(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 2 has 4 cells, but there are 5 columns"):
        read(tmp_path, "0,1,2,3,4\n0.1,1,2,3\n")


@pytest.mark.parametrize(
    ("columns", "row"),
    [
        ("x1,y1,x2,y2", "0.1,1,2"),
        ("x1,y1,x2,y2", "0.1,1,2,"),
        ("x1,y1,v1,x2,y2,v2", "0.1,1,2"),
        ("x1,x2,y1,y2", "0.1,1,,2"),
    ],
)
def test_empty_cells_at_the_end_may_be_left_off(tmp_path: Path, columns: str, row: str) -> None:
    full = f"0,{','.join('1' * len(columns.split(',')))}"
    file = read(tmp_path, f"t,{columns}\n{full}\n{row}\n")
    assert xy(file, "1") == [[1, 1], [1, 2]]
    assert xy(file, "2") == [[1, 1]]


@pytest.mark.parametrize("name", ["a", "red"])
def test_columns_of_one_name_are_told(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=f"two columns named x_{name}; rename one"):
        read(tmp_path, f"t,x_{name},y_{name},x_{name},y_{name}\n0,1,2,3,4\n")


def test_the_one_pair_of_centres_is_named_after_the_file(tmp_path: Path) -> None:
    assert stones(read(tmp_path, "t,xpos,ypos\n0,1,2\n", name="A.csv")) == ["A"]


def test_pairs_beside_plain_columns_are_not_swallowed(tmp_path: Path) -> None:
    file = read(tmp_path, "t,x,y,x2,y2\n0,1,2,3,4\n")
    assert stones(file) == ["shot"]
    assert "x and y of 2" in file.warnings[0]


@pytest.mark.parametrize("angle", ["ang_a", "theta_a", "a_theta", "angle a"])
def test_angles_find_their_stone(tmp_path: Path, angle: str) -> None:
    file = read(tmp_path, f"t,{angle},xa,ya,xb,yb\n0,0.5,1,2,3,4\n")
    assert file.tracks.set_index("stone")["theta"]["a"] == 0.5
    assert np.isnan(file.tracks.set_index("stone")["theta"]["b"])


@pytest.mark.parametrize(
    ("title", "names"),
    [
        (";red stone;;;yellow;;;", ["red stone", "yellow"]),
        (";a;b;;;c;d;;;", ["a;b", "c;d"]),  # nothing is quoted in Tracker's exports
        ("", ["A", "B"]),
    ],
)
def test_names_of_tracks(tmp_path: Path, title: str, names: list[str]) -> None:
    header = "t;x;y;vx;x;y;vx;"
    file = read(tmp_path, f"#multi:\n{title}\n{header}\n0;1;2;9;3;4;9\n1;1;2;9;3;4;9\n")
    assert stones(file) == names


def test_one_name_for_two_tracks_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="two stones with one name, red"):
        read(tmp_path, "#multi:\n\tred\t\tred\t\t\nt\tx\ty\tx\ty\t\n0\t1\t1\t2\t2\n")


def test_a_track_without_marks_is_left_out(tmp_path: Path) -> None:
    file = read(tmp_path, "#multi:\n,red,,blue,,\nt,x,y,x,y,\n0,1,2,,\n1,1,2,,\n")
    assert stones(file) == ["red"]
    assert "blue has no place" in file.warnings[0]
