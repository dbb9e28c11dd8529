from __future__ import annotations

import pytest

from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import FCV1
from curlshot.physics.impact import Frictional, Impact, PointMass
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.tests.helpers.physics.many import (
    BOTH_MOVE,
    FROZEN,
    HOUSE,
    R,
    assert_same,
    one_by_one,
    thrown,
)


@pytest.mark.parametrize("stones", [HOUSE[:1], HOUSE, FROZEN, BOTH_MOVE])
@pytest.mark.parametrize("impact", [PointMass(0.0), PointMass(1.0), Frictional(0.83, 0.2)])
def test_each_variant_ends_as_it_does_alone(stones: tuple[StoneStart, ...], impact: Impact) -> None:
    shot = Shot(stones, impact, FCV1(), FCV1Curl(), R)
    states = thrown(shot)
    assert_same(simulate_many(shot, states), one_by_one(shot, states))
