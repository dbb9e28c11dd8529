from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import pipeline
from data.sheet import HOUSE, SHEET
from data.tracks import TRACK_COLUMNS
from report import tables
from report.summary import summary
from report.tables.teams import colour_word, team_names
from report.units import FEET

MU_G = 0.0109 * 9.81


def glide(
    name: str,
    place: tuple[float, float],
    speed: float = 0.0,
    *,
    end: float = 20.0,
    turn: float = 0.0,
    team: str = "",
    sd: float = 0.003,
) -> pd.DataFrame:
    """A stone that comes down y, turning its path to the left at a rate, until it stops."""
    t = np.arange(0, end, 0.04)
    v = np.maximum(speed - MU_G * t, 0.0)
    heading = -np.pi / 2 + np.where(v > 0, turn * t, turn * speed / MU_G)
    velocity = v[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    steps = (velocity[1:] + velocity[:-1]) / 2 * 0.04
    xy = place + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    table = pd.DataFrame({"stone": name, "frame": np.arange(len(t)), "t": t})
    table[["x", "y"]], table[["vx", "vy"]] = xy, velocity
    table["omega"] = np.where(v > 0, 1.5, 0.0)
    table["theta"] = np.cumsum(table["omega"]) * 0.04
    for column in ("x", "y", "theta", "vx", "vy", "omega"):
        table[f"sd_{column}"] = sd
    return table.assign(seen=1, team=team)[list(TRACK_COLUMNS)]


def test_speeds_at_the_lines_are_those_of_the_closed_form():
    tracks = glide("A", (0.3, 8.0), 1.6)
    table = tables.speed_table(tracks, ()).set_index("at")
    for at, y in (("hog line", SHEET.hog_line), ("tee line", 0.0)):
        speed = np.sqrt(1.6**2 - 2 * MU_G * (8.0 - y))
        assert table.loc[at, "speed"] == pytest.approx(speed, abs=1e-3)
        assert table.loc[at, "t"] == pytest.approx((1.6 - speed) / MU_G, abs=0.01)
        assert table.loc[at, "sd"] == pytest.approx(0.003, rel=0.01)
    assert table["note"].isna().all()


def test_a_line_that_was_not_passed_in_view_has_a_reason():
    table = tables.speed_table(glide("A", (0.3, 4.0), 0.8), ()).set_index("at")
    assert table["speed"].isna().all()
    assert table.loc["hog line", "note"] == "first seen 2.4 m past it"
    way = 0.8**2 / (2 * MU_G)
    assert table.loc["tee line", "note"].startswith(f"came no nearer than {4.0 - way:.1f} m")


def test_stones_from_the_other_end_pass_the_other_hog_line():
    tracks = glide("A", (0.0, 8.0), 1.6)
    tracks[["y", "vy"]] *= -1
    assert tables.speed_table(tracks, ())["speed"].notna().all()


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
    assert rest.loc["A", "note"] == "still moves at 0.29 m/s as the clip ends"
    assert rest.loc["B", "to_tee"] == pytest.approx(1.0)
    assert rest.loc["B", "sd_to_tee"] == pytest.approx(0.003)
    assert tables.shot_stone(rest.reset_index()) == (None, "where A stopped is not known")


def test_a_stone_that_left_the_house_does_not_matter():
    away = glide("A", (0.0, -2.5), 1.5, end=2.0)
    rest = tables.rest_table(pd.concat([away, glide("B", (0.6, 0.8), end=4.0)]))
    assert rest["note"].iloc[0] == "out of sight after 2.0 s, at 1.30 m/s"
    assert rest["in_house"].tolist() == [0, 1]
    assert tables.shot_stone(rest)[0] == "B"


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
    assert tables.shot_stone(lying(places)) == ("A", "teams are not known")
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


def test_takeouts_tell_what_was_lost(shot):
    table = tables.takeout_table(shot.results.collisions)
    hit = shot.results.collisions[0]
    arrived, left = (np.hypot(s["A"].vx, s["A"].vy) for s in (hit.before, hit.after))
    row = table.iloc[0]
    assert (row["arrived"], row["left"]) == pytest.approx((arrived, left))
    assert row["share"] == pytest.approx(1 - left / arrived)
    assert 0.012 < row["sd_lost"] < 0.022
    assert row["struck"] == pytest.approx(np.hypot(hit.after["B"].vx, hit.after["B"].vy))


@pytest.mark.parametrize(
    ("colour", "word"),
    [
        ("#c02030", "red"),
        ("#e8d020", "yellow"),
        ("#2040c0", "blue"),
        ("#208040", "green"),
        ("#f0f0f0", "white"),
        ("#101010", "black"),
        ("Team Sweden", "Team Sweden"),
        ("", ""),
    ],
)
def test_colours_have_words(colour: str, word: str):
    assert colour_word(colour) == word


def test_two_teams_of_one_colour_word_keep_their_colours():
    tracks = pd.concat(
        [glide("A", (0, 0), end=1.0, team="#c02030"), glide("B", (1, 0), end=1.0, team="#e03040")]
    )
    assert team_names(tracks) == {"A": "#c02030", "B": "#e03040"}


def test_the_summary_says_how_far_the_last_places_may_be_off(shot):
    score = replace(
        shot.results.simulations["frictional"],
        rmse=0.02,
        rest_error={"A": 0.031},
        rest_sd={"A": 0.05},
    )
    text = summary(replace(shot.results, simulations={"frictional": score}), shot.tracks)
    assert "frictional: 2.0 cm RMS off; at the end A 3.1 cm (± 5.0 cm)" in text
    unknown = replace(shot.results, simulations={"frictional": replace(score, rest_sd={})})
    assert "at the end" not in summary(unknown, shot.tracks)


def test_the_summary_says_who_lies_shot_in_the_unit_asked_for(shot):
    text = summary(shot.results, shot.tracks, house=HOUSE)
    (line,) = [line for line in text.splitlines() if line.startswith("shot stone")]
    rest = tables.rest_table(shot.tracks, shot.results.collisions)
    name, why = tables.shot_stone(rest)
    distance = rest.loc[rest["stone"] == name, "to_tee"].iloc[0]
    assert line == f"shot stone  {name}, {distance:.2f} m from the tee; {why}"
    assert "3.1 cm RMS" in text
    feet = summary(shot.results, shot.tracks, house=HOUSE, unit=FEET)
    assert f"{name}, {distance / 0.3048:.1f} ft from the tee" in feet
    assert "1.2 in RMS" in feet
    assert "shot stone" not in summary(shot.results, shot.tracks)


@pytest.mark.parametrize(("unit", "said"), [("m", "m from the tee"), ("ft", "ft from the tee")])
def test_the_command_takes_the_unit(tmp_path, capsys, unit: str, said: str):
    tracks = pd.concat([glide("A", (0.3, 3.0), 1.0), glide("B", (0.6, 0.8))])
    tracks.to_csv(tmp_path / "glide.csv", index=False)
    words = ["estimate", "-q", str(tmp_path / "glide.csv"), "-o", str(tmp_path / "out")]
    assert pipeline.main([*words, "--units", unit]) == 0
    (line,) = [k for k in capsys.readouterr().out.splitlines() if k.startswith("shot stone")]
    assert said in line
