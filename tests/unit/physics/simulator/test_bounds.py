from __future__ import annotations

import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import Constant
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulation import StoneStart
from curlshot.tests.helpers.physics.bounds import BACK, HOG, straight


def test_a_stone_that_is_gone_hits_nothing() -> None:
    behind = StoneStart("B", 0, BACK + 1.0)
    thrown = StoneStart("A", 0, -1, 0, 3.0)
    assert straight(thrown, behind, bounds=None).hits != ()
    assert straight(thrown, behind).hits == ()
    # What lies out of play is left there.
    assert straight(thrown, behind).rest["B"].in_play


def test_play_goes_either_way() -> None:
    up, down = StoneStart("A", 0, 0, 0, 1.0), StoneStart("B", 1, 0, 0, -1.0)
    assert set(straight(up, down).gone) == {"A"}
    assert set(straight(up, down, bounds=Bounds(play=-1)).gone) == {"B"}


def test_a_stone_short_of_the_hog_line_is_taken_away_unless_it_hit_another() -> None:
    short = StoneStart("A", 0, -HOG - 2, 0, 0.5)
    sim = straight(short)
    assert sim.gone["A"] == pytest.approx(0.5 / (Constant().friction * GRAVITY))
    assert sim.rest["A"].y < -HOG
    guard = StoneStart("B", 0, -HOG - 1.2)
    assert straight(short, guard).hits != ()
    assert straight(short, guard).gone == {}
    assert straight(StoneStart("A", 0, -HOG - 1, 0, 0.8)).gone == {}
