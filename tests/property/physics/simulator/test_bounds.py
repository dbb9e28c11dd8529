from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import Constant
from curlshot.physics.simulator.simulation import StoneStart
from curlshot.tests.helpers.physics.bounds import BACK, SIDE, straight


@settings(deadline=None)
@given(st.floats(0.3, 4.0), st.floats(0.0, math.pi))
def test_a_stone_leaves_where_it_crosses_a_line(speed: float, angle: float) -> None:
    a = Constant().friction * GRAVITY
    ways = {
        SIDE / abs(math.cos(angle)) if math.cos(angle) else math.inf,
        BACK / math.sin(angle) if math.sin(angle) else math.inf,
    }
    way = min(ways)
    stone = StoneStart("A", 0, 0, speed * math.cos(angle), speed * math.sin(angle))
    sim = straight(stone)
    left = speed**2 - 2 * a * way
    if abs(left) < 1e-6:
        return
    if left < 0:
        assert sim.gone == {}
        assert sim.rest["A"].in_play
        return
    assert sim.gone["A"] == pytest.approx((speed - math.sqrt(left)) / a, abs=1e-7)
    rest = sim.rest["A"]
    assert not rest.in_play
    assert (rest.x, rest.y) == pytest.approx(
        (way * math.cos(angle), way * math.sin(angle)), abs=1e-7
    )
    times = np.linspace(0, 2 * sim.gone["A"], 11)
    assert sim.sample(times)["t"].max() <= sim.gone["A"]
