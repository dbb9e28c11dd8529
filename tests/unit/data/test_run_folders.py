from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from curlshot.data.errors import InputError
from curlshot.data.results import Estimate, Friction, Input, Results
from curlshot.data.results_file import write_results
from curlshot.data.run_folders import apart, find_results, read_runs, season_folder
from curlshot.season.together import combine


def written(folder: Path, radius: float = 0.1455) -> Path:
    folder.mkdir(parents=True)
    nothing = Results(Input(("a.mp4",), 25.0, 10, 0.4), Estimate(), Friction(), radius=radius)
    write_results(nothing, folder / "results.json")
    return folder


def test_clips_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    clips = [tmp_path / "a" / "shot.mp4", tmp_path / "b" / "shot.mp4", tmp_path / "c.mp4"]
    assert list(apart(clips)) == ["a-shot", "b-shot", "c"]
    again = [tmp_path / "a" / "shot.mp4", tmp_path / "a" / "shot.mov"]
    assert list(apart(again)) == ["a-shot", "a-shot-2"]
    # Names that differ by case alone are one on some systems.
    cased = [tmp_path / "a" / "Shot.mp4", tmp_path / "b" / "shot.mp4", tmp_path / "A" / "SHOT.mp4"]
    assert list(apart(cased)) == ["a-Shot", "b-shot", "A-SHOT-3"]


def test_names_that_are_no_text_are_told_as_far_as_they_are(tmp_path: Path) -> None:
    clips = [tmp_path / f"\udcff{folder}" / "\udcfc.mp4" for folder in "ab"]
    assert list(apart(clips)) == ["?a-?", "?b-?"]


def test_runs_are_found_in_folders_of_folders(tmp_path: Path) -> None:
    one, two = written(tmp_path / "season" / "one"), written(tmp_path / "season" / "two")
    assert list(read_runs(find_results([tmp_path / "season"]))) == ["one", "two"]
    assert list(read_runs(find_results(str(one)))) == ["one"]
    assert list(read_runs(find_results([two, one / "results.json", two]))) == ["two", "one"]
    # Not every shell looks for what matches a pattern.
    assert list(read_runs(find_results(str(tmp_path / "sea*" / "*o*")))) == ["one", "two"]


def test_a_run_without_results_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="name the folders of runs"):
        read_runs(find_results([tmp_path]))


def test_runs_of_stones_and_of_pucks_are_no_season(tmp_path: Path) -> None:
    runs = [written(tmp_path / "stones"), written(tmp_path / "pucks", 0.0465)]
    with pytest.raises(
        InputError, match=r"^pucks: its discs have a radius of 0.0465 m, .*0.1455 m"
    ):
        read_runs(find_results(runs))


def test_a_season_is_not_written_into_the_folder_of_a_run(tmp_path: Path) -> None:
    assert season_folder(tmp_path) == tmp_path
    (tmp_path / "results.json").write_text("{}", encoding="utf-8")
    with pytest.raises(InputError, match="holds a run itself; name another folder with `out`"):
        combine(tmp_path, tmp_path)


def test_the_files_of_a_season_name_options(tmp_path: Path) -> None:
    run = written(tmp_path / "run")
    results = replace(
        read_runs(find_results(run))["run"], warnings=("friction: wrong frame rate (`fps`)",)
    )
    write_results(results, run / "results.json")
    season = combine(run, tmp_path / "season")
    assert season.shots["note"].tolist() == ["friction: wrong frame rate (`fps`)"]
    assert "wrong frame rate (--fps)" in (tmp_path / "season" / "shots.csv").read_text("utf-8")
    assert "`fps`" not in (tmp_path / "season" / "season.html").read_text("utf-8")
