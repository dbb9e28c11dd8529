"""A run as a notebook sees it: what it prints, its tables, its figures, and loading it again."""

from __future__ import annotations

import json
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

import curlshot
from curlshot.cli.main import main
from curlshot.data.results import Estimate, Friction
from curlshot.data.tracks import MEASURED_AS, TRACK_COLUMNS

MOST_LINES, MOST_BYTES = 15, 60_000

TRACKS_1 = """\
stone,frame,t,x,y,theta,vx,vy,omega,sd_x,sd_y,sd_theta,sd_vx,sd_vy,sd_omega,seen,team,seen_x,seen_y
A,0,0,0.1,2,,0,-1.5,,0.001,0.001,,0.01,0.01,,1,,0.101,2.001
A,1,0.5,0.1,1.25,,0,-1.45,,0.001,0.001,,0.01,0.01,,0,,,
B,0,0,0,0,,0,0,,0.001,0.001,,0.01,0.01,,1,,0,0.001
B,1,0.5,0,0,,0,0,,0.001,0.001,,0.01,0.01,,1,,0.001,0
"""
RESULTS_1 = {
    "schema": 1,
    "input": {"files": ["old.mp4"], "fps": 2.0, "frames": 2, "duration": 0.5},
    "restitution": {"value": 0.83, "stderr": 0.02},
    "friction": {"value": None, "stderr": None, "law": "constant", "a": None, "v_c": None,
                 "b": None},
    "collisions": [],
    "glides": [{"stone": "A", "t0": 0.0, "t1": 0.5, "friction": 0.01, "stderr": 0.004,
                "turn": 0.001, "stderr_turn": 0.002, "speed": 1.4}],
    "simulations": {"frictional": {"rmse": 0.01, "rest_error": {"A": 0.02}, "note": None,
                                   "hits": [], "rest_sd": {"A": 0.03}}},
    "warnings": ["friction: too little is seen to tell it"],
    "radius": 0.1455,
    "laws": None,
    "stones": {"A": {"friction": {"value": 0.01, "stderr": 0.004},
                     "turn": {"value": 0.001, "stderr": 0.002}, "speed": 1.4,
                     "spin": {"value": None, "stderr": None}}},
    "sheet": True,
}  # fmt: skip
"""A run's results as version 0.1 wrote them."""


@pytest.fixture(autouse=True)
def no_window() -> None:
    mpl.use("agg")
    plt.close("all")


@pytest.fixture
def old(tmp_path: Path) -> Path:
    """The folder of a run that version 0.1 wrote, with the fewest files."""
    folder = tmp_path / "old"
    folder.mkdir()
    (folder / "results.json").write_text(json.dumps(RESULTS_1), encoding="utf-8")
    (folder / "tracks.csv").write_text(TRACKS_1, encoding="utf-8")
    return folder


def test_a_run_prints_its_answer_in_a_few_lines(sample: curlshot.Run) -> None:
    text = repr(sample)
    assert len(text.splitlines()) <= MOST_LINES
    assert f"restitution e = {sample.restitution}" in text and f"μ = {sample.friction}" in text
    results = sample.results
    many = replace(sample, results=replace(results, collisions=results.collisions * 40))
    assert len(repr(many).splitlines()) <= MOST_LINES and "and 76 more hits" in repr(many)


def test_a_run_shows_answer_plan_and_hits_in_a_notebook(sample: curlshot.Run) -> None:
    page = sample._repr_html_()
    assert len(page.encode()) <= MOST_BYTES
    assert "<svg" in page and page.count("<tr><td>") == len(sample.hits) == 2
    assert str(sample.restitution) in page
    named = replace(sample, results=replace(sample.results, warnings=("<script>",)))
    assert "<script>" not in named._repr_html_()


def test_the_command_prints_the_summary(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], sample: curlshot.Run
) -> None:
    assert sample.out is not None
    out = tmp_path / "out"
    assert main(["estimate", str(sample.out / "tracks.csv"), "-o", str(out), "-q"]) == 0
    said = capsys.readouterr().out
    again = curlshot.load(out)
    assert again.tracks.empty and again.cameras is None
    assert said.splitlines()[2:6] == again.summary().splitlines()[2:6]
    assert "(--no-house if it is not)" in said and "(`no_house` if it is not)" in again.summary()
    with pytest.raises(curlshot.InputError, match=r"no tracks\.csv"):
        again.plot()


def test_tables_have_units(sample: curlshot.Run) -> None:
    assert list(sample.tracks) == [*TRACK_COLUMNS, *MEASURED_AS]
    for table in (sample.tracks, sample.hits, sample.glides, sample.stones):
        assert list(table.attrs["units"]) == list(table)
    assert sample.tracks.attrs["units"]["meas_sd_x"] == "m"
    assert sample.hits.attrs["units"]["stderr_t"] == "s"
    for table in (sample.glides, sample.stones):
        assert table.attrs["units"]["turn_rate"] == "rad/s" and "turn" not in table
    for name, table in (("glides", sample.glides), ("stones", sample.stones)):
        described = re.findall(r"\w+", getattr(type(sample), name).__doc__ or "")
        assert {column.removeprefix("sd_") for column in table} <= set(described)
    hits = sample.hits
    assert (hits["closing_speed"] > 0.9).all() and hits["first"].tolist() == ["A", "B"]
    first = sample.stones.set_index("stone").loc["A"]
    assert np.hypot(first["x"], first["y"]) == pytest.approx(first["to_tee"])
    no_house = replace(sample, house=None).stones
    assert no_house["to_tee"].isna().all() and no_house["x"].notna().any()


def test_a_run_that_was_loaded_is_the_same(sample: curlshot.Run) -> None:
    assert sample.out is not None
    for place in (sample.out, str(sample.out / "results.json")):
        again = curlshot.load(place)
        pd.testing.assert_frame_equal(again.tracks, sample.tracks, rtol=1e-6, check_dtype=False)
        assert again.summary() == sample.summary()
        assert again.tracks.attrs == sample.tracks.attrs
    assert again.simulated.keys() == sample.simulated.keys()
    one, two = sample.residuals, again.residuals
    pd.testing.assert_frame_equal(one, two, rtol=1e-3, atol=1e-7, check_dtype=False)
    with pytest.raises(curlshot.InputError, match="copy its folder"):
        again.report(sample.out)


def test_a_folder_of_version_0_1_is_read(old: Path) -> None:
    run = curlshot.load(old)
    assert f"{run.restitution}" == "0.830 ± 0.020"
    assert str(run.friction) == "— (friction: too little is seen to tell it)"
    assert run.tracks["meas_x"].tolist()[0] == 0.101 and "seen_x" not in run.tracks
    assert run.glides.loc[0, "stone"] == "A" and run.stones.loc[0, "friction"] == 0.01
    assert run.ensemble is None and run.cameras is None and run.simulations.empty
    assert len(run.residuals) == 3
    assert "old.mp4" in repr(run)
    with pytest.raises(curlshot.InputError, match="no shot to throw again"):
        curlshot.simulate(run)


def test_what_is_no_run_is_named_in_one_line(old: Path, tmp_path: Path) -> None:
    (old / "results.json").unlink()
    with pytest.raises(curlshot.InputError, match=r"no results\.json in it, only tracks\.csv"):
        curlshot.load(old)
    with pytest.raises(curlshot.InputError, match="no such folder"):
        curlshot.load(tmp_path / "none")


def test_a_run_without_tracks_draws_what_needs_none(sample: curlshot.Run, tmp_path: Path) -> None:
    assert sample.out is not None
    folder = shutil.copytree(sample.out, tmp_path / "run")
    (folder / "tracks.csv").unlink()
    run = curlshot.load(folder)
    assert len(run.plot_hit()) == 2 and run.plot_posterior()[0].has_data()
    needs = (run.plot, run.plot_motion, run.plot_spin, run.plot_comparison, run.plot_residuals)
    for draw in (*needs, lambda: curlshot.simulate(run)):
        with pytest.raises(curlshot.InputError, match=r"no tracks\.csv in it"):
            draw()


FIGURES = {
    "plot": 1, "plot_speed": 1, "plot_friction": 1, "plot_motion": 3, "plot_spin": 2,
    "plot_comparison": 2, "plot_hit": 2, "plot_residuals": 4, "plot_posterior": 9,
}  # fmt: skip


@pytest.mark.parametrize("name", FIGURES)
def test_figures_are_drawn_on_new_axes_or_on_given_ones(name: str, sample: curlshot.Run) -> None:
    names = sample.results.joint_estimate.names if sample.results.joint_estimate else ()
    count = FIGURES[name]
    if name == "plot_posterior":
        count = len({"restitution", "friction", "stone_friction"} & set(names)) ** 2
    own = np.ravel(getattr(sample, name)())
    assert len(own) == count
    assert own[0].figure.number in plt.get_fignums()  # so that a notebook shows it
    figure, given = plt.subplots(count, 1, squeeze=False, figsize=(6, 3 * count))
    drawn = np.ravel(getattr(sample, name)(ax=given[:, 0] if count > 1 else given[0, 0]))
    assert [*drawn] == [*given[:, 0]] and all(ax.has_data() or ax.texts for ax in drawn[:1])
    assert given[0, 0].get_title(loc="left")
    figure.draw_without_rendering()
    if count > 1:
        with pytest.raises(curlshot.InputError, match="axes given"):
            getattr(sample, name)(ax=given[0, 0])


def test_what_is_not_there_is_named(sample: curlshot.Run) -> None:
    with pytest.raises(curlshot.InputError, match="there is no 'Z'; there are: A, B"):
        sample.plot_motion("Z")
    with pytest.raises(curlshot.InputError, match="hit: there is no 3; there are: 1, 2"):
        sample.plot_hit(3)
    with pytest.raises(curlshot.InputError, match="model: there is no 'magic'"):
        sample.plot_comparison(model="magic")


def test_tracks_are_a_dataset_as_movement_has_them(
    sample: curlshot.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("xarray")
    data = sample.to_xarray()
    assert data["position"].dims == ("time", "space", "individuals")
    row = sample.tracks[sample.tracks["stone"] == "B"].iloc[7]
    there = data.sel(individuals="B", time=row["t"])
    assert there["position"].to_numpy().tolist() == [row["x"], row["y"]]
    assert float(there["angular_velocity_sd"]) == row["sd_omega"]
    assert data["velocity"].attrs["units"] == "m/s" and data.attrs["time_unit"] == "seconds"
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(curlshot.CurlshotError, match="pip install xarray"):
        sample.to_xarray()


def test_a_measured_shot_is_thrown_again(sample: curlshot.Run) -> None:
    assert sample.out is not None
    again = curlshot.simulate(sample)
    assert repr(curlshot.simulate(sample.out)) == repr(again)
    faster = curlshot.simulate(curlshot.load(sample.out), speed="1.1x", aim_offset=0.02)
    assert faster.hits[0].t < again.hits[0].t
    assert len(repr(again).splitlines()) <= MOST_LINES
    assert [*again.sample([0.0, 1.0]).attrs["units"]][:3] == ["stone", "frame", "t"]
    outcomes, odds = again.throw(20)
    assert outcomes["sample"].nunique() == odds["samples"] == 20
    axes = plt.figure().subplots()
    assert again.plot(axes) is axes


def test_what_is_unknown_says_why(sample: curlshot.Run) -> None:
    warnings = ("restitution: no hit detected", "friction: no glide")
    bare = replace(sample.results, restitution=Estimate(), friction=Friction(), warnings=warnings)
    run = replace(sample, results=bare)
    assert (
        str(run.e) == "— (restitution: no hit detected)"
        and str(run.friction) == "— (friction: no glide)"
    )
    assert re.search(r"e</th><td[^>]*>— \(restitution", run._repr_html_())
