from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table
from curlshot.data.tracks import (
    DETECTION_COLUMNS,
    TRACK_COLUMNS,
    check_detections,
    empty_tracks,
    read_tracks,
    stone_name,
    teams,
    write_table,
    write_tracks,
)


def shot() -> pd.DataFrame:
    t = np.arange(5) / 25
    a = pd.DataFrame({"stone": "A", "t": t, "x": 0.1 * t, "y": 2 - t})
    b = pd.DataFrame({"stone": "B", "t": t[2:], "x": 0.5, "y": 0.25})
    return pd.concat([a, b], ignore_index=True)


def full_tracks() -> pd.DataFrame:
    table = check_detections(shot()).assign(seen=1)
    rest = [name for name in TRACK_COLUMNS if name not in table]
    return table.assign(**dict.fromkeys(rest, 1 / 3), theta=0.123456789)


def test_missing_columns_are_filled_and_rows_sorted() -> None:
    mixed = shot().sample(frac=1, random_state=1).sort_values("t", kind="stable")
    table = check_detections(mixed)
    assert tuple(table.columns) == DETECTION_COLUMNS
    assert list(table["stone"]) == ["A"] * 5 + ["B"] * 3
    assert list(table["frame"]) == [0, 1, 2, 3, 4, 2, 3, 4]
    assert table[["theta", "sd_x", "sd_y", "sd_theta"]].isna().all(axis=None)
    pd.testing.assert_frame_equal(check_detections(table), table)


def test_rows_without_a_place_are_no_detections() -> None:
    table = shot()
    table.loc[1, "x"] = np.nan
    table.loc[6, "y"] = np.nan
    assert len(check_detections(table)) == len(table) - 2


def test_numbers_as_text_are_numbers() -> None:
    table = shot().astype(str)
    pd.testing.assert_frame_equal(check_detections(table), check_detections(shot()))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"x": "one"}, "column x is not a number in data row 3"),
        ({"x": np.inf}, "infinite numbers in column x"),
        ({"t": np.nan}, "a time is missing"),
        ({"t": -np.inf}, "infinite numbers in column t"),
        ({"theta": np.inf}, "infinite numbers in column theta"),
        ({"t": 0.0}, "stone A: time goes back after t = 0.04 s"),
        ({"t": 0.04}, "stone A: two rows at t = 0.04 s"),
        ({"stone": None}, "a stone without a name"),
        ({"frame": 0.5}, "no frames"),
        ({"frame": 1e300}, "no frames"),
        ({"sd_y": -0.1}, "a standard deviation is negative"),
        ({"sd_place_x": -0.1}, "a standard deviation is negative"),
    ],
)
def test_faults_are_named(change: dict[str, object], reason: str) -> None:
    table = check_detections(shot()).astype(object)
    for name, wrong in change.items():
        table.loc[2, name] = wrong
    with pytest.raises(InputError, match=reason) as refusal:
        check_detections(table, "shot.csv")
    assert str(refusal.value).startswith("shot.csv: ")


def test_all_faults_stand_in_one_line() -> None:
    table = shot().assign(sd_x=-1.0)
    table.loc[2, "t"] = 0.0
    with pytest.raises(InputError) as refusal:
        check_detections(table)
    assert "time goes back" in str(refusal.value)
    assert "negative" in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("gone", ["stone", "t", "x", "y"])
def test_needed_columns(gone: str) -> None:
    with pytest.raises(InputError, match=f"no column {gone}"):
        check_detections(shot().drop(columns=gone))


def test_a_table_without_places_is_refused() -> None:
    with pytest.raises(InputError, match="no row with a place"):
        check_detections(shot().assign(x=np.nan))
    with pytest.raises(InputError, match="no row with a place"):
        check_detections(empty_tracks())


def test_tracks_come_back_to_nine_digits(tmp_path: Path) -> None:
    tracks = full_tracks()
    write_tracks(tracks, tmp_path / "out" / "tracks.csv")
    text = (tmp_path / "out" / "tracks.csv").read_text()
    assert text.splitlines()[0] == ",".join(TRACK_COLUMNS)
    assert "\r" not in text
    found = read_table([tmp_path / "out" / "tracks.csv"]).detections
    wanted = check_detections(tracks)
    pd.testing.assert_frame_equal(found, wanted, rtol=1e-8)


def test_rows_that_the_filter_carried_are_no_measurements(tmp_path: Path) -> None:
    tracks = full_tracks()
    tracks.loc[3, "seen"] = 0
    write_tracks(tracks, tmp_path / "tracks.csv")
    assert len(read_table([tmp_path / "tracks.csv"]).detections) == len(tracks) - 1


def test_names_that_look_like_numbers_stay_names(tmp_path: Path) -> None:
    write_tracks(full_tracks().assign(stone="007"), tmp_path / "tracks.csv")
    with pytest.raises(InputError, match="stone 007"):
        read_table([tmp_path / "tracks.csv"])


def test_missing_numbers_are_written_as_nothing(tmp_path: Path) -> None:
    write_table(pd.DataFrame({"a": [1.0, np.nan]}), tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text().splitlines() == ["a", "1", '""']


@pytest.mark.parametrize(
    "text",
    ["", "\0\0", "stone,t,x,y\nA,0,1,1,7\n", "hello", 'stone,t,x,y\n"A,0,1,1\n', "a,b\n1,2\n"],
)
def test_what_is_no_table_of_tracks_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "tracks.csv"
    path.write_text(text)
    with pytest.raises(InputError) as refusal:
        read_table([path])
    assert "\n" not in str(refusal.value)


def test_missing_tracks_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_table([tmp_path / "tracks.csv"])


def test_names_of_stones() -> None:
    assert [stone_name(k) for k in (0, 1, 25, 26, 52)] == ["A", "B", "Z", "A1", "A2"]
    assert len({stone_name(k) for k in range(200)}) == 200


def test_no_tracks_have_the_columns_of_tracks() -> None:
    assert tuple(empty_tracks().columns) == TRACK_COLUMNS
    assert len(empty_tracks()) == 0


@pytest.mark.parametrize(
    "wrong", ["", "A,0,0,nan,0,0,1,1,0,1,1,1,1,1,1,1", "A,0,0,1e300,0" + ",0" * 10 + ",1"]
)
def test_written_tracks_without_sense_are_refused(tmp_path: Path, wrong: str) -> None:
    path = tmp_path / "tracks.csv"
    path.write_text(",".join(TRACK_COLUMNS) + "\n" + wrong + "\n")
    with pytest.raises(InputError, match=r"without any row|are not numbers"):
        read_tracks(path)


def test_teams_are_kept_in_all_that_is_written(tmp_path: Path) -> None:
    given = shot().assign(team=["red"] * 4 + [None] * 4)
    table = check_detections(given)
    assert teams(table) == {"A": "red", "B": ""}
    path = tmp_path / "tracks.csv"
    write_tracks(full_tracks().assign(team=table["team"]), path)
    assert teams(read_tracks(path)) == {"A": "red", "B": ""}
    without = pd.read_csv(path).drop(columns="team")
    without.to_csv(path, index=False)
    assert teams(read_tracks(path)) == {"A": "", "B": ""}


def test_a_long_table_is_written_whole_in_little_memory(tmp_path: Path) -> None:
    table = {"t": np.arange(20_001) / 3, "n": np.arange(20_001)}
    tracemalloc.start()
    begin = tracemalloc.get_traced_memory()[0]
    write_table(table, tmp_path / "long.csv")
    most = tracemalloc.get_traced_memory()[1] - begin
    tracemalloc.stop()
    assert most < 1e6
    read = pd.read_csv(tmp_path / "long.csv")
    np.testing.assert_allclose(read["t"], table["t"], rtol=1e-8)
    np.testing.assert_array_equal(read["n"], table["n"])
