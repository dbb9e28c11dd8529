from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from curlshot import pipeline
from curlshot.cli.main import main
from curlshot.config import Config
from curlshot.data.errors import InputError
from curlshot.data.results import Estimate, Friction, Results
from curlshot.data.results_file import write_results
from curlshot.outcome import Run
from curlshot.physics.statistics.season import hits_table, pooled, shots_table
from curlshot.report.season import season_figure
from curlshot.season.batch import run_each
from curlshot.season.together import combine
from curlshot.tests.helpers.report.shots import BARE, SHOT


def test_a_shot_says_why_it_does_not_tell_e_or_friction(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    unseen, short = (
        "restitution: no hit detected",
        "friction: not identifiable, no stone glides freely for long enough",
    )
    rub = "friction between the stones not identifiable: 0.2, as in the shot fit"
    told = replace(SHOT, warnings=(rub, "the friction differs from glide to glide"))
    bare = replace(BARE, warnings=(unseen, "D is not followed", rub, short))
    no_hit = replace(SHOT, restitution=Estimate(), warnings=(unseen, short))
    shots = shots_table({"told": told, "bare": bare, "no hit": no_hit})
    assert shots["note"].tolist() == ["", f"{unseen}; {short}", unseen]
    for name, shot in (("a", told), ("b", bare)):
        write_results(shot, tmp_path / name / "results.json")
    assert main(["season", str(tmp_path), "-o", str(tmp_path / "out")]) == 0
    assert f"{unseen}; {short}" in capsys.readouterr().out.splitlines()[2]


@pytest.mark.parametrize("runs", [{}, {"none": BARE}, {"a $ <b>" * 9: SHOT, "none": BARE}])
def test_picture_of_any_season(runs: dict[str, Results]) -> None:
    shots = shots_table(runs)
    figure = season_figure(shots, hits_table(runs), pooled(shots))
    figure.draw_without_rendering()


def test_command_reads_folders_of_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, value in (("x", 0.80), ("y", 0.86)):
        (tmp_path / "runs" / name).mkdir(parents=True)
        shot = replace(SHOT, restitution=Estimate(value, 0.001))
        write_results(shot, tmp_path / "runs" / name / "results.json")
    out = tmp_path / "out"
    assert main(["season", str(tmp_path / "runs"), "-o", str(out)]) == 0
    assert "e = 0.83" in capsys.readouterr().out
    content = json.loads((out / "season.json").read_text("utf-8"))
    assert content["shots"] == ["x", "y"]
    assert content["restitution"]["value"] == pytest.approx(0.83)
    assert content["restitution"]["stderr"] > 0.02
    assert pd.read_csv(out / "shots.csv")["restitution"].tolist() == [0.80, 0.86]
    assert (out / "season.png").stat().st_size > 10_000


def test_shots_stand_in_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, stderr in (("x", 0.1), ("longer", 0.00111)):
        (tmp_path / "runs" / name).mkdir(parents=True)
        shot = replace(SHOT, restitution=Estimate(0.8, stderr))
        write_results(shot, tmp_path / "runs" / name / "results.json")
    main(["season", str(tmp_path / "runs"), "-o", str(tmp_path / "out")])
    first, second = capsys.readouterr().out.splitlines()[:2]
    assert first.index("e =") == second.index("e =")
    assert first.index("μ =") == second.index("μ =")


def test_one_shot_says_that_its_scatter_is_assumed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, value in (("one", 0.82), ("two", 0.83)):
        (tmp_path / name).mkdir()
        shot = replace(SHOT, restitution=Estimate(value, 0.01))
        write_results(shot, tmp_path / name / "results.json")
        assert main(["season", str(tmp_path), "-o", str(tmp_path / "out")]) == 0
        said = capsys.readouterr().out.count("assumed to be about 0.05")
        assert said == (1 if name == "one" else 0)


def test_friction_below_zero_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, value in (("good", 0.011), ("bad-one", -0.004)):
        shot = replace(SHOT, friction=Friction(value, 0.001))
        write_results(shot, tmp_path / name / "results.json")
    assert main(["season", str(tmp_path), "-o", str(tmp_path / "out")]) == 0
    warnings = [line for line in capsys.readouterr().out.splitlines() if "warning" in line]
    assert len(warnings) == 1
    assert "bad-one: μ = −0.0040 ± 0.0010 is impossible" in warnings[0]


def test_a_shot_that_is_there_twice_counts_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A copied run, under another name of its clip too, made its errors smaller."""
    other = replace(SHOT, restitution=Estimate(0.86, 0.01))
    renamed = replace(SHOT, input=replace(SHOT.input, files=("b.mp4",)))
    for name, shot in {"one": SHOT, "three": other, "two": renamed}.items():
        write_results(shot, tmp_path / name / "results.json")
    assert main(["season", str(tmp_path), "-o", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out
    assert "two   the same shot as one: counted once" in said and "of 2 shots" in said
    assert pd.read_csv(tmp_path / "out" / "shots.csv")["shot"].tolist() == ["one", "three"]
    both = combine({"a": BARE, "b": BARE})  # of which nothing is known that could be alike
    assert len(both.shots) == 2 and both.means["restitution"].value is None


def test_one_bad_clip_does_not_stop_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def run_or_not(clips: list[Path], out: Path, *_: object) -> Run:
        if clips[0].stem == "bad":
            raise InputError(f"{clips[0]}: not a video")
        shot = replace(SHOT, friction=Friction(0.01 + len(clips[0].stem) / 1e4, 0.001))
        return Run(pd.DataFrame(), None, shot, pd.DataFrame(), out)

    monkeypatch.setattr("curlshot.season.batch.run", run_or_not)
    for name in ("good.mp4", "bad.mp4", "other.mp4"):
        (tmp_path / name).touch()
    clips = [str(tmp_path / name) for name in ("good.mp4", "bad.mp4", "other.mp4")]
    # In another process nothing is replaced.
    assert main(["run", *clips, "-o", str(tmp_path / "out"), "-q", "--jobs", "1"]) == 0
    said = capsys.readouterr().out
    assert "bad" in said and "not a video" in said and "2 shots" in said
    assert main(["run", clips[1], clips[1], "-o", str(tmp_path / "none"), "-q"]) == 2
    assert "none of 2 clips" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_two_clips_at_once_come_to_what_one_after_the_other_does(tmp_path: Path) -> None:
    for name in ("one.mp4", "two.mp4"):
        shutil.copy(pipeline.sample_clip(), tmp_path / name)
    clips = [*sorted(tmp_path.glob("*.mp4")), tmp_path / "none.mp4"]
    settings = Config().replace(frames=(0, 12), overlay=False)
    found = {}
    for jobs in (1, 2):
        done, failed = run_each(clips, tmp_path / str(jobs), settings, jobs=jobs)
        assert list(done) == ["one", "two"] and list(failed) == ["none"]
        assert all((tmp_path / str(jobs) / name / "report.html").exists() for name in done)
        found[jobs] = done
    for name in ("one", "two"):
        pd.testing.assert_frame_equal(found[1][name].tracks, found[2][name].tracks)
        assert found[1][name].results == found[2][name].results
