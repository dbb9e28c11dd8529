from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from report import tables


def test_stones_are_summed_up(shot):
    table = tables.stone_table(shot.tracks).set_index("stone")
    assert list(table.index) == ["A", "B", "C", "D"]
    a = shot.tracks[shot.tracks["stone"] == "A"]
    assert table.loc["A", "top_speed"] == pytest.approx(np.hypot(0.05, 1.5))
    assert table.loc["A", "x1"] == a["x"].iloc[-1]
    assert table.loc["D", "path"] == 0
    assert table.loc["B", "seen"] == pytest.approx(159 / 170)
    assert table.loc["A", "sd"] == pytest.approx(0.004)


def test_scores_name_every_stone(shot):
    table = tables.score_table(shot.results.simulations)
    stated = ["sd_A", "sd_B", "sd_C"]
    assert list(table.columns) == ["model", "rmse", "A", "B", "C", *stated, "note"]
    assert len(tables.glide_table(shot.results.glides)) == 3
    assert list(tables.hit_table(shot.results.collisions)["hit"]) == [1, 2]


def test_only_stones_that_moved_count_as_moving(shot):
    assert tables.moving_stones(shot.tracks) == ("A", "B", "C")
    still = shot.tracks[shot.tracks["stone"] == "D"].copy()
    still["x"] += np.random.default_rng(1).normal(0, 0.01, len(still))
    assert tables.moving_stones(still) == ()
    assert tables.moving_stones(shot.tracks[shot.tracks["frame"] == 0]) == ()


@pytest.mark.parametrize("rows", [2, 3, 5, 12])
def test_a_stone_may_have_moved_in_a_few_rows(rows: int) -> None:
    glide = pd.DataFrame({"stone": "A", "x": 0.0, "y": np.linspace(0, 0.7, rows)})
    assert tables.moving_stones(glide) == ("A",)
    assert tables.moving_stones(glide.assign(y=0.02 * glide["y"])) == ()
