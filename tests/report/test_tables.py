from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from data.results import MeasuredState
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


def test_measured_states_are_those_of_the_results(shot):
    table = tables.measured_table(shot.results.collisions)
    row = table[(table["hit"] == 2) & (table["stone"] == "C") & (table["when"] == "after")].iloc[0]
    state = shot.results.collisions[1].after["C"]
    assert (row["x"], row["vy"], row["omega"]) == (state.x, state.vy, state.omega)


def test_simulated_hits_stand_beside_the_measured_ones(shot):
    collisions = shot.results.collisions
    score = shot.results.simulations["point-mass"]
    truth = tables.measured_table(collisions)
    found = tables.simulated_table(score, collisions)
    assert list(found.columns) == list(truth.columns)
    assert found[["hit", "stone", "when"]].equals(truth[["hit", "stone", "when"]])
    row = found[(found["hit"] == 2) & (found["stone"] == "C") & (found["when"] == "after")].iloc[0]
    assert row["vy"] == score.hits[1].after["C"].vy
    assert row["sd_vy"] == 0.015


def test_hits_that_only_one_of_the_two_has_are_told_apart(shot):
    collisions = shot.results.collisions
    score = shot.results.simulations["point-mass"]
    missed = dataclasses.replace(score, hits=score.hits[:1])
    found = tables.simulated_table(missed, collisions)
    assert found.loc[found["hit"] == 1, "vx"].notna().all()
    assert found.loc[found["hit"] == 2, ["t", "x", "vx"]].isna().all().all()
    more = tables.simulated_table(score, collisions[:1])
    assert more["hit"].tolist()[:4] == [1] * 4
    assert more["hit"].isna().tolist()[4:] == [True] * 4


def test_the_axes_of_a_hit_keep_speed_and_error():
    state = MeasuredState(0, 0, 3.0, 4.0, None, 0, 0, 0.1, 0.1)
    (along, sd_n), (across, sd_t) = tables.in_axes(state, (0.6, 0.8))
    assert (along, across) == pytest.approx((5.0, 0.0))
    assert (sd_n, sd_t) == pytest.approx((0.1, 0.1))
    assert tables.in_axes(MeasuredState(0, 0, 1, 0), (0, 1)) == ((0, None), (-1, None))


def test_laws_stand_beside_the_literature_for_curling_stones_only(shot):
    table = tables.law_table(shot.results)
    assert table["symbol"].tolist() == ["e", "μ", "μₛ"]
    assert table["value"].tolist() == pytest.approx([0.8312345, 0.01093456, 0.05])
    assert table["stderr"].iloc[2] == pytest.approx(0.01)
    assert table["literature"].iloc[0] == 0.83
    pucks = tables.law_table(dataclasses.replace(shot.results, radius=0.035))
    assert pucks[["literature", "low"]].isna().all().all()


def test_scores_name_every_stone(shot):
    table = tables.score_table(shot.results.simulations)
    assert list(table.columns) == ["model", "rmse", "A", "B", "C", "note"]
    assert len(tables.glide_table(shot.results.glides)) == 3
    assert list(tables.hit_table(shot.results.collisions)["hit"]) == [1, 2]


def test_only_stones_that_moved_count_as_moving(shot):
    assert tables.moving_stones(shot.tracks) == ("A", "B", "C")
    still = shot.tracks[shot.tracks["stone"] == "D"].copy()
    still["x"] += np.random.default_rng(1).normal(0, 0.01, len(still))
    assert tables.moving_stones(still) == ()
    assert tables.moving_stones(shot.tracks[shot.tracks["frame"] == 0]) == ()


def test_methods_laws_and_stones_are_listed(shot):
    methods = tables.method_table(shot.results).set_index("method")
    assert methods.loc["local", "hit 1"] == 0.83
    assert np.isnan(methods.loc["global", "hit 2"])
    assert methods.loc["global", "note"] == "one fit"
    choices = tables.choice_table(shot.results)
    assert choices["laws"].tolist() == ["ice constant", "ice fit"]
    assert choices["weight"].sum() == pytest.approx(1.0)
    (ice,) = tables.ice_table(shot.results).to_dict("records")
    assert (ice["stone"], ice["friction"], ice["sd_spin"]) == ("A", 0.0112, 0.01)
