from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.start import measured_start
from curlshot.physics.prediction.throws import along_sheet, foreseen_until, later_throws
from curlshot.physics.simulator.simulation import StoneStart
from curlshot.tests.helpers.physics.measured import R, measured
from curlshot.tests.helpers.physics.throws import two_throws
from curlshot.tests.helpers.physics.watch import RADIUS


@pytest.fixture(scope="module")
def both() -> tuple[pd.DataFrame, pd.DataFrame, Estimates]:
    seen = two_throws()
    hits = detect_hits(seen, RADIUS)
    assert [hit.stones for hit in hits] == [("A", "B"), ("C", "A")]
    return seen, smooth(seen, hits, radius=RADIUS), estimate(seen, hits, radius=RADIUS)


def rows(stone: str, begins: float, speeds: Sequence[float], sd: float = 0.01) -> pd.DataFrame:
    """Rows of a track, 25 a second, with these speeds."""
    t = begins + np.arange(len(speeds)) / 25
    return pd.DataFrame({"stone": stone, "t": t, "vx": 0.0, "vy": speeds, "sd_vx": sd, "sd_vy": sd})


@pytest.mark.parametrize(
    ("first", "second", "later"),
    [
        ([0.5] * 25 + [0.02] * 75, [0.13] * 30, True),
        ([0.5] * 25 + [0.045] * 75, [0.13] * 30, False),  # it still goes
        ([0.5] * 25 + [0.02] * 75, [0.065] * 30, False),  # as a stone at rest may seem to
        ([0.5] * 25 + [0.02] * 75, [0.0] * 5 + [0.5] * 30, False),  # set off by something in view
        ([0.5] * 25 + [0.02] * 75, [0.5] * 2 + [0.0] * 30, False),  # first seen in part
        ([0.12] * 25 + [0.02] * 75, [0.5] * 30, True),
        ([0.06] * 25 + [0.02] * 75, [0.5] * 30, False),  # nothing was thrown before
    ],
)
def test_how_fast_a_stone_is_that_was_thrown(
    first: list[float], second: list[float], later: bool
) -> None:
    told = later_throws(pd.concat([rows("A", 0, first), rows("B", 5, second)], ignore_index=True))
    assert told == ({"B": 5.0} if later else {})


def test_speeds_that_are_hardly_known_are_no_throw() -> None:
    thrown = rows("A", 5, [1.5] * 50)
    assert later_throws(pd.concat([rows("B", 0, [0.3] * 9 + [0.0] * 9), thrown], ignore_index=True))
    unsure = rows("B", 0, [0.3] * 9 + [0.0] * 9, sd=0.2)
    assert not later_throws(pd.concat([unsure, thrown], ignore_index=True))


@pytest.mark.parametrize(
    ("turn", "dx", "dy", "there"),
    [(0, 0, 0, True), (2, 0, 0, True), (0, 1.5, 2.0, True), (1, 0, 0, False), (0, 6, 2.5, False)],
)
def test_a_shot_along_a_sheet_comes_along_y_within_its_sides(
    turn: int, dx: float, dy: float, there: bool
) -> None:
    """Turned by right angles and moved, as where the origin is anywhere."""
    tracks, results, _ = measured()
    turned = tracks.copy()
    for x, y in (("x", "y"), ("vx", "vy")):
        place = (tracks[x] + 1j * tracks[y]) * 1j**turn
        turned[x], turned[y] = place.to_numpy().real, place.to_numpy().imag
    turned[["x", "y"]] += [dx, dy]
    assert along_sheet(turned, results.collisions[0].t, R) == there


def test_one_wild_velocity_of_a_stone_at_rest_is_no_throw_across() -> None:
    tracks, results, _ = measured()
    wild = tracks[tracks["stone"] == "C"].index[10]
    tracks.loc[wild, "vx"] = 5.0
    assert along_sheet(tracks, results.collisions[0].t, R)


def test_a_stone_that_comes_in_later_does_not_lie_in_the_way_of_a_what_if() -> None:
    tracks, results, ensemble = measured()
    thrown = tracks[(tracks["stone"] == "A") & (tracks["t"] < 2)]
    tracks = pd.concat([tracks, thrown.assign(stone="D", t=thrown["t"] + 6.0)])
    start = measured_start(tracks, results, ensemble)
    assert [stone.name for stone in start.shot.stones] == ["A", "B", "C"]
    assert start.assumed["left out"].endswith("D at 6.00 s")


@pytest.mark.parametrize(
    ("begins", "another", "known"), [(2.0, 12, True), (8.0, 12, False), (8.0, 0, True)]
)
def test_stones_first_seen_at_rest_were_hidden_unless_another_is_thrown_then(
    begins: float, another: float, known: bool
) -> None:
    tracks, results, ensemble = measured()
    thrown = tracks[(tracks["stone"] == "A") & (tracks["t"] < 2)]
    lies = thrown.assign(stone="D", t=thrown["t"] + begins, x=0.1, y=-0.5, vx=0.0, vy=0.0)
    tracks = pd.concat([tracks, lies, thrown.assign(stone="E", t=thrown["t"] + another)])
    if not another:
        tracks = tracks[tracks["stone"] != "E"]
    late = StoneStart("D", 0.1, -0.5), StoneStart("E", 1.2, 3.0, 0.0, -1.6)
    likely = replace(ensemble.likely, stones=(*ensemble.likely.stones, *late))
    start = measured_start(tracks, results, replace(ensemble, likely=likely, others=()))
    assert ("D" in [stone.name for stone in start.shot.stones]) == known
    assert ("D at 8.00 s, E at 12.00 s" in start.assumed.get("left out", "")) != known


def test_what_an_unknown_stone_sets_going_is_not_foreseen(both) -> None:
    (first, second) = both[2].collisions
    third = replace(second, t=9.0, stones=("A", "B"))
    ends = {"A": np.inf, "B": np.inf, "D": 3.0}
    known = {"A", "B", "D"}
    assert foreseen_until(ends, (first,), known) == ends
    assert foreseen_until(ends, (third, second, first), known) == {
        "A": second.t, "B": 9.0, "C": second.t, "D": 3.0,
    }  # fmt: skip
