from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.report import tables


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


def test_a_cap_that_is_taken_out_for_the_tracks_is_no_residual():
    t = np.arange(0.0, 5.0, 1 / 30)
    centre = pd.DataFrame({"stone": "A", "frame": np.arange(len(t)), "t": t, "theta": 1.6 * t})
    centre["x"], centre["y"] = 0.3, t - 0.045 * t**2
    seen = centre.assign(sd_x=0.0005, sd_y=0.0005, sd_theta=0.01)
    seen = seen.assign(sd_place_x=0.002, sd_place_y=0.002)
    seen["x"] += 0.004 * np.cos(seen["theta"])
    seen["y"] += 0.004 * np.sin(seen["theta"])
    rest = tables.residual_table(seen, centre)
    assert np.abs(rest[["dx", "dy"]]).to_numpy().max() < 0.001
    shown = tables.residual_table(seen.assign(theta=np.nan), centre)
    assert np.abs(shown[["dx", "dy"]]).to_numpy().max() > 0.003


def test_stones_come_down_or_up_as_the_thrown_one_does(shot):
    up = shot.tracks.assign(y=-shot.tracks["y"], vy=-shot.tracks["vy"])
    assert (tables.play(shot.tracks), tables.play(up)) == (-1, 1)
    assert tables.play(shot.tracks[shot.tracks["frame"] == 0]) == -1
