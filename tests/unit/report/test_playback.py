from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from curlshot.data.sheet import HOUSE
from curlshot.report.playback import STEPS, differences, playback


def decoded(values: list[int], column: str) -> np.ndarray:
    return np.cumsum(values) * STEPS[column]


def test_columns_come_back_to_half_a_step(shot):
    data = json.loads(json.dumps(playback(shot.results, shot.tracks, shot.simulations, HOUSE)))
    times = decoded(data["t"], "t")
    for stone in data["stones"]:
        rows = shot.tracks[shot.tracks["stone"] == stone["name"]]
        np.testing.assert_allclose(times[np.cumsum(stone["at"])], rows["t"], atol=STEPS["t"] / 2)
        for name in ("x", "y", "theta", "omega"):
            off = np.abs(decoded(stone[name], name) - rows[name].to_numpy(float))
            assert off.max() <= 0.5001 * STEPS[name]
        speed = np.hypot(rows["vx"], rows["vy"])
        assert np.abs(decoded(stone["speed"], "speed") - speed).max() <= 0.5001 * STEPS["speed"]
    assert [hit["stones"] for hit in data["hits"]] == [["A", "B"], ["B", "C"]]


def test_what_is_not_known_keeps_the_value_before():
    assert decoded(differences([np.nan, 1.0, np.nan, 2.0], "x").copy(), "x") == pytest.approx(
        [0.0, 1.0, 1.0, 2.0]
    )


def test_simulated_stones_at_rest_take_one_row(shot):
    data = playback(shot.results, shot.tracks, shot.simulations, HOUSE)
    rows = {s["name"]: len(s["x"]) for s in data["simulations"]["frictional"]}
    assert rows["D"] == 1
    assert rows["A"] == shot.tracks["frame"].nunique()


def test_lines_lie_as_the_stones_come(shot):
    up = shot.tracks.assign(y=-shot.tracks["y"], vy=-shot.tracks["vy"])
    for tracks, way in ((shot.tracks, -1), (up, 1)):
        bare = dataclasses.replace(shot.results, collisions=())
        assert playback(bare, tracks, {}, HOUSE)["lines"]["play"] == way


def test_without_a_house_there_are_no_rings(shot):
    data = playback(shot.results, shot.tracks, {}, None)
    assert data["rings"] == [] and data["lines"] == {} and data["simulations"] == {}


def test_hits_lie_where_the_stones_touch(shot):
    data = playback(shot.results, shot.tracks, {}, HOUSE)
    for hit, collision in zip(data["hits"], shot.results.collisions, strict=True):
        for stone in collision.stones:
            state = collision.before[stone]
            away = np.hypot(hit["x"] - state.x, hit["y"] - state.y)
            assert away == pytest.approx(shot.results.radius, abs=1e-6)
