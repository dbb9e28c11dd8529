from __future__ import annotations

import numpy as np
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


def test_measured_states_are_those_of_the_results(shot):
    table = tables.measured_table(shot.results.collisions)
    row = table[(table["hit"] == 2) & (table["stone"] == "C") & (table["when"] == "after")].iloc[0]
    state = shot.results.collisions[1].after["C"]
    assert (row["x"], row["vy"], row["omega"]) == (state.x, state.vy, state.omega)


def test_hits_are_found_in_a_sampled_simulation(shot):
    collisions = shot.results.collisions
    truth = tables.measured_table(collisions)
    simulation = shot.tracks[["stone", "frame", "t", "x", "y", "theta", "vx", "vy", "omega"]]
    found = tables.simulated_table(simulation, collisions)
    assert list(found["hit"]) == list(truth["hit"])
    for name in ("vx", "vy"):
        # Half a frame of slowing by the ice at most.
        np.testing.assert_allclose(found[name], truth[name].astype(float), atol=0.005)


def test_a_simulation_without_the_hit_says_nothing(shot):
    simulation = shot.simulations["point-mass"].copy()
    simulation.loc[simulation["stone"] == "C", ["vx", "vy"]] = 0.0
    found = tables.simulated_table(simulation, shot.results.collisions)
    assert found.loc[found["hit"] == 1, "vx"].notna().all()
    assert found.loc[found["hit"] == 2, ["t", "x", "vx"]].isna().all().all()
    none = tables.simulated_table(simulation.iloc[:0], shot.results.collisions)
    assert len(none) == 8
    assert none["vx"].isna().all()


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
