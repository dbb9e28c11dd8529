from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.data.results import Estimate
from curlshot.data.results_file import write_results
from curlshot.data.run_folders import find_results, read_runs
from curlshot.physics.statistics.season import hits_table, pooled, shots_table
from curlshot.report.season import season_figure
from curlshot.season.together import combine
from curlshot.tests.helpers.report.shots import BARE, SHOT


def test_tables_say_what_the_results_say() -> None:
    shots, hits = shots_table({"one": SHOT, "none": BARE}), hits_table({"one": SHOT, "none": BARE})
    assert shots["shot"].tolist() == ["one", "none"]
    assert shots.loc[0, "restitution"] == 0.82 and np.isnan(shots.loc[1, "restitution"])
    assert len(hits) == 1
    # Closing at 0.6 · (1.2 − 0.3) + 0.8 · (1.6 − 0.4).
    assert hits.loc[0, "closing_speed"] == pytest.approx(1.5)


def test_mean_leaves_out_what_is_not_known() -> None:
    means = pooled(shots_table({"one": SHOT, "none": BARE}))
    assert means["restitution"].shots == 1
    assert means["restitution"].value == pytest.approx(0.82)
    assert pooled(shots_table({"none": BARE}))["friction"].value is None


def test_scatter_and_standard_error_are_told_apart_whichever_is_wider() -> None:
    shots = shots_table({"one": SHOT, "two": SHOT})
    means = pooled(shots)
    for scatter in (0.001, 0.1):
        mean = replace(means["restitution"], stderr=0.01, scatter=scatter)
        figure = season_figure(shots, hits_table({}), means | {"restitution": mean})
        error, spread = figure.axes[0].patches
        assert error.get_fill() and not spread.get_fill()
        assert [patch.get_label() for patch in (error, spread)] == [
            "its standard error", "scatter from shot to shot"
        ]  # fmt: skip


def test_runs_of_one_name_are_told_apart(tmp_path: Path) -> None:
    for parent, value in (("p", 0.82), ("q", 0.83)):
        (tmp_path / parent / "shot").mkdir(parents=True)
        shot = replace(SHOT, restitution=Estimate(value, 0.01))
        write_results(shot, tmp_path / parent / "shot" / "results.json")
    found = read_runs(
        find_results([tmp_path / "p" / "shot", tmp_path / "q" / "shot", tmp_path / "p" / "shot"])
    )
    assert list(found) == ["p-shot", "q-shot"]
    assert combine(found).shots["shot"].tolist() == ["p-shot", "q-shot"]


def test_folder_without_runs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="name the folders of runs"):
        read_runs(find_results([tmp_path]))
    with pytest.raises(InputError, match="no runs given"):
        read_runs(find_results([]))


def test_runs_of_a_folder_are_in_their_natural_order(tmp_path: Path) -> None:
    names = ["end 1 [red]", "end 2", "end 10"]
    for name in names:
        write_results(SHOT, tmp_path / "season [a]" / name / "results.json")
    assert list(read_runs(find_results([tmp_path / "season [a]"]))) == names
    by_shell = sorted((tmp_path / "season [a]").iterdir())
    assert list(read_runs(find_results(by_shell))) == names


def test_dots_in_names_of_folders_stay(tmp_path: Path) -> None:
    for name in ("2026.01.05", "2026.01.06"):
        (tmp_path / name).mkdir()
        write_results(SHOT, tmp_path / name / "results.json")
    assert list(read_runs(find_results([tmp_path]))) == ["2026.01.05", "2026.01.06"]
