from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.report import tables
from curlshot.tests.helpers.report.glides import MU_G, glide


@pytest.mark.parametrize("turn", [0.02, -0.02, 0.0])
def test_curl_is_the_way_off_the_line_of_setting_out(turn: float):
    tracks = glide("A", (0.0, 8.0), 1.6, turn=turn)
    row = tables.rest_table(tracks).iloc[0]
    truth = tracks["x"].iloc[-1]  # it set out straight down y: left of it is +x
    assert row["curl"] == pytest.approx(truth, abs=0.06)
    assert abs(row["curl"] - truth) < 3 * row["sd_curl"] + 0.05
    assert (row["curl"] > 0) == (turn > 0) or turn == 0
    assert row["turns"] == pytest.approx(1.5 * 1.6 / MU_G / (2 * np.pi), rel=0.01)


def test_a_short_way_tells_no_curl():
    row = tables.rest_table(glide("A", (0.0, 2.0), 1.0, end=1.0, sd=0.2)).iloc[0]
    assert np.isnan(row["curl"])
    assert "curl" in row["note"]


def test_places_are_told_of_stones_that_have_stopped():
    tracks = pd.concat([glide("A", (0.0, 3.0), 0.7, end=4.0), glide("B", (0.6, 0.8), end=4.0)])
    rest = tables.rest_table(tracks).set_index("stone")
    assert np.isnan(rest.loc["A", "x"])
    assert rest.loc["A", "note"] == "still moving at 0.29 m/s at the end of the clip"
    assert rest.loc["B", "to_tee"] == pytest.approx(1.0)
    assert rest.loc["B", "sd_to_tee"] == pytest.approx(0.003)
    assert tables.shot_stone(rest.reset_index()) == (None, "the last places of A are unknown")


def test_a_stone_that_left_the_house_does_not_matter():
    away = glide("A", (0.0, -2.5), 1.5, end=2.0)
    rest = tables.rest_table(pd.concat([away, glide("B", (0.6, 0.8), end=4.0)]))
    assert rest["note"].iloc[0] == "out of sight after 2.0 s, at 1.30 m/s"
    assert rest["in_house"].tolist() == [0, 1]
    assert tables.shot_stone(rest)[0] == "B"


def test_a_stone_that_moves_away_from_the_tee_does_not_lie_shot():
    away = glide("A", (0.0, -0.9), 1.0, end=0.5)  # still in the house, and on its way out
    rest = tables.rest_table(pd.concat([away, glide("B", (0.3, 0.4), end=0.9)]))
    assert np.isnan(rest["in_house"].iloc[0])
    assert rest["beyond"].iloc[0] == pytest.approx(1.4, abs=0.05)
    assert tables.shot_stone(rest) == ("B", "A still moved, farther from the tee and away from it")
    far = tables.rest_table(pd.concat([away, glide("B", (0.9, 1.2), end=0.9)]))
    assert tables.shot_stone(far) == (None, "the last places of A are unknown")


def lying(places: dict[str, float], teams: dict[str, str] | None = None) -> pd.DataFrame:
    rows = [glide(k, (0.0, y), end=1.0, team=(teams or {}).get(k, "")) for k, y in places.items()]
    return tables.rest_table(pd.concat(rows))


def test_who_lies_shot_and_how_many_count():
    places = {"A": 0.3, "B": -0.9, "C": 1.2, "D": 3.0}
    rest = lying(places, {"A": "#c02030", "B": "#d02828", "C": "#e8d020", "D": "#e8d020"})
    assert rest.set_index("stone")["lies"].tolist()[:3] == [1, 2, 3]
    assert np.isnan(rest["lies"].iloc[3])
    assert tables.shot_stone(rest)[0] == "A"
    rest = lying(places, {"A": "ours", "B": "ours", "C": "theirs", "D": "theirs"})
    assert tables.shot_stone(rest) == ("A", "ours lies 2")
    assert tables.shot_stone(lying(places)) == ("A", "the teams are unknown")
    assert tables.shot_stone(lying({"A": 4.0})) == (None, "no stone is in the house")


def test_a_measure_is_too_close_to_tell_between_teams_only():
    near = {"A": 0.500, "B": -0.504}
    assert tables.shot_stone(lying(near, {"A": "x", "B": "y"}))[0] is None
    assert tables.shot_stone(lying(near, {"A": "x", "B": "x"})) == ("A", "x lies 2")
    assert tables.shot_stone(lying({"A": 0.5, "B": -0.52}, {"A": "x", "B": "y"}))[0] == "A"


def test_distances_are_symmetric_and_of_known_stones_only():
    table = tables.distance_table(lying({"A": 0.3, "B": -0.9, "C": 1.2}))
    assert table["tee"].tolist() == pytest.approx([0.3, 0.9, 1.2])
    apart = table[["to A", "to B", "to C"]].to_numpy()
    assert np.isnan(np.diag(apart)).all()
    np.testing.assert_allclose(apart[0, 1:], [1.2, 0.9])
    np.testing.assert_array_equal(apart, apart.T)
    assert tables.distance_table(lying({"A": 0.3}).iloc[:0]).empty


def test_errors_of_distances_are_those_of_both_places():
    table = lying({"A": 0.3, "B": -0.9}).assign(sd_x=[0.003, 0.004], sd_y=[0.003, 0.004])
    apart = tables.distance_table(table)
    np.testing.assert_allclose(apart["sd_tee"], [0.003, 0.004])
    np.testing.assert_allclose(apart[["sd_to A", "sd_to B"]], [[np.nan, 0.005], [0.005, np.nan]])


@pytest.mark.parametrize(
    ("speed", "last"), [(0.0, 0.0), (0.02, 0.0), (0.045, 0.045), (np.nan, 0.0)]
)
def test_a_stone_that_creeps_has_stopped(speed: float, last: float):
    t = np.arange(50) / 25
    track = pd.DataFrame({"t": t, "vx": np.where(t < 1.5, 0.5, speed), "vy": 0.0})
    assert tables.last_speed(track) == pytest.approx(last)
