from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.stone_names import chosen, named_by_file, refuse_shared_names
from curlshot.data.track_file import TrackFile


def files(**tracks: list[str]) -> tuple[list[Path], list[TrackFile]]:
    """Files by their stems, each with tracks of those names."""
    made = [
        TrackFile(pd.DataFrame({"stone": names, "t": 0.0, "x": 1.0, "y": 2.0}))
        for names in tracks.values()
    ]
    return [Path(f"{stem}.txt") for stem in tracks], made


def stones(given: list[TrackFile]) -> list[list[str]]:
    return [list(file.tracks["stone"]) for file in given]


def test_tracks_that_are_named_are_kept_under_their_stones_names():
    paths, made = files(one=["mass A", "line"], two=["mass B"], three=["other"])
    kept_paths, kept = chosen(paths, made, {"A": "mass A", "B": "mass B"})
    assert stones(kept) == [["A"], ["B"]]
    assert [path.stem for path in kept_paths] == ["one", "two"]


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ({"A": "mass C"}, "no track named mass C; there are mass A"),
        ({"A": "mass A", "B": "mass A"}, "cannot be two stones"),
    ],
)
def test_tracks_that_are_not_there_or_twice_are_refused(names, said):
    with pytest.raises(InputError, match=said):
        chosen(*files(one=["mass A"]), names)


def test_one_name_in_several_files_becomes_the_files():
    paths, made = files(red=["mass A"], blue=["mass A"])
    named, (warning,) = named_by_file(paths, made)
    assert stones(named) == [["red"], ["blue"]]
    assert "named after the files instead: red, blue" in warning
    refuse_shared_names(paths, named)


@pytest.mark.parametrize(
    "tracks",
    [
        {"red": ["mass A", "mass B"], "blue": ["mass A"]},
        {"red": ["mass A"], "blue": ["mass A"], "both": ["red", "x"]},
    ],
)
def test_where_files_cannot_tell_them_apart_they_are_refused(tracks):
    paths, made = files(**tracks)
    named, warnings = named_by_file(paths, made)
    assert warnings == []
    with pytest.raises(InputError, match=r"blue\.txt: two stones with one name, mass A"):
        refuse_shared_names(paths, named)
