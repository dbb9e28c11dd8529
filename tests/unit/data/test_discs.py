from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.discs import refuse_no_discs, top_speed
from curlshot.data.errors import InputError
from curlshot.data.sheet import STONE
from curlshot.data.tracks import check_detections
from curlshot.tests.helpers.data.discs import shot
from curlshot.tests.helpers.physics.watch import RADIUS


def test_discs_that_hit_pass() -> None:
    refuse_no_discs(shot(), RADIUS, "a.txt")
    refuse_no_discs(shot(), STONE.radius, "a.txt")
    refuse_no_discs(shot(0.2), 0.2 * RADIUS, "a.txt")


@pytest.mark.parametrize("size", [0.3048, 0.0254, 0.01, 0.001])
def test_discs_in_one_another_are_refused(size: float) -> None:
    """Metres taken for feet, inches, centimetres, millimetres."""
    with pytest.raises(InputError, match=r"a\.txt: A and B come within .* but discs of radius"):
        refuse_no_discs(shot(size), RADIUS, "a.txt")


def test_a_point_of_the_edge_is_no_stone() -> None:
    a = shot().query("stone == 'A'")
    edge = a.assign(stone="edge", x=a["x"] + 0.14)
    with pytest.raises(InputError, match=r"A and edge come within 14 cm .* \(`names`\)"):
        refuse_no_discs(pd.concat([a, edge]), RADIUS, "a.txt")


def test_one_slipped_mark_is_no_evidence() -> None:
    table = shot()
    row = table.index[(table["stone"] == "A")][3]
    table.loc[row, ["x", "y"]] = 0.0
    refuse_no_discs(table, 0.12, "a.txt")  # no stones: they may be fast


def test_stones_faster_than_any_are_refused_but_not_other_discs() -> None:
    t = np.arange(20) / 25 - 5.13e-5  # even steps through times that were rounded
    table = check_detections(
        pd.DataFrame({"stone": "A", "t": t, "x": 7.0 * t - t**2 / 99, "y": 0.0})
    )
    with pytest.raises(InputError, match=r"7\.0 m/s at t = 0 s, faster than any curling stone"):
        refuse_no_discs(table, STONE.radius, "a.txt")
    refuse_no_discs(table, 0.03, "a.txt")


def test_top_speed_is_hardly_moved_by_noise() -> None:
    rng = np.random.default_rng(1)
    t = np.arange(1000) / 500
    xy = np.column_stack([1.5 * t, 0 * t]) + rng.normal(0, 0.002, (1000, 2))
    speed, _ = top_speed(t, xy)
    assert speed == pytest.approx(1.5, abs=0.15)
    assert top_speed(t[:1], xy[:1]) == (0.0, 0.0)
