from __future__ import annotations

from dataclasses import replace

from curlshot.data.coach_units import FEET
from curlshot.data.results import Prediction
from curlshot.data.sheet import HOUSE
from curlshot.report import tables
from curlshot.report.summary import summary


def test_the_law_is_named_beside_a_friction_that_is_known(shot):
    friction = replace(shot.results.friction, value=0.0107, stderr=0.0002, law="fit")
    text = summary(replace(shot.results, friction=friction), shot.tracks)
    assert "friction    μ = 0.01070 ± 0.00020 (fit, at 1 m/s)\n" in text
    none = replace(friction, value=None, stderr=None)
    assert "friction    μ = —\n" in summary(replace(shot.results, friction=none), shot.tracks)


def test_the_summary_says_how_far_the_last_places_may_be_off(shot):
    score = replace(
        shot.results.simulations["frictional"],
        rmse=0.02,
        rest_error={"A": 0.031, "B": 0.0012, "C": 1.0, "D": 0.2},
        rest_sd={"A": 0.05, "B": 0.002, "C": None, "D": 0.1},
    )
    text = summary(replace(shot.results, simulations={"frictional": score}), shot.tracks)
    how = "frictional, fitted shot" if shot.results.joint_estimate is not None else "frictional"
    lines = text.splitlines()
    said = lines.index(f"simulated   {how}: 2.0 cm RMS error")
    off = "at the end      A 3.1 cm (± 5.0 cm), B 1.2 mm (± 2.0 mm), D 20.0 cm (± 10.0 cm)"
    assert lines[said + 1] == f"            {off}"
    apart = summary(replace(shot.results, joint_estimate=None), shot.tracks)
    assert "simulated   frictional: " in apart and "fitted shot" not in apart
    unknown = replace(shot.results, simulations={"frictional": replace(score, rest_sd={})})
    assert "at the end" not in summary(unknown, shot.tracks)


def test_models_that_come_to_the_same_are_said_together(shot):
    """Without a hit all did, three times two lines of the same numbers."""
    one = shot.results.simulations["frictional"]
    scores = {"point-mass": one, "rigid-body": replace(one, rmse=0.5), "frictional": one}
    lines = summary(replace(shot.results, simulations=scores), shot.tracks).splitlines()
    said = [
        line.split(":")[0].removesuffix(", fitted shot") for line in lines if "simulated" in line
    ]
    assert said == ["simulated   point-mass, frictional", "simulated   rigid-body"]


def test_the_summary_of_many_stones_keeps_to_the_width_of_a_terminal(shot):
    off = dict.fromkeys("ABCDEFG", 0.1234)
    guess = Prediction(0.1, off, off, error_at_comparison=off, sd_at_comparison=off)
    text = summary(replace(shot.results, predictions={"frictional": guess}), shot.tracks)
    lines = [line for line in text.splitlines() if "(±" in line or "RMS" in line]
    assert sum(line.count("(±") for line in lines) == 14
    assert max(map(len, lines)) <= 100
    assert [line.endswith(",") for line in lines[-3:]] == [True, True, False]


def test_the_summary_says_of_how_much_of_a_clip_the_stones_are_known(shot):
    used = shot.tracks["frame"].nunique()
    read = replace(shot.results.input, frames=used, duration=4.13)
    text = summary(replace(shot.results, input=read), shot.tracks)
    assert f": {used} frames, 4.13 s" in text
    more = replace(read, frames=used + 55)
    text = summary(replace(shot.results, input=more), shot.tracks)
    assert f": {used + 55} frames; stones in {used} of them, over 4.13 s" in text


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
