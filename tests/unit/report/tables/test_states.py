from __future__ import annotations

import dataclasses

import pytest

from curlshot.data.results import MeasuredState
from curlshot.report import tables


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
