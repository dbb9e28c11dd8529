"""When two stones meet, against paths sampled densely."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Penner
from curlshot.physics.simulator.approach import first_contact
from curlshot.physics.simulator.motion import Motion, Path

REACH = 0.291
ICES = ((FCV1(), FCV1Curl()), (Constant(0.01), NoCurl()), (Penner(), FCV1Curl(turn=0.05)))
places = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
speeds = st.sampled_from([0.0, 0.02, 0.3, 1.0, 3.0])
stones = st.tuples(places, speeds, st.floats(-math.pi, math.pi), st.sampled_from([-2.0, 0.0, 0.3]))
Stone = tuple[tuple[float, float], float, float, float]


def path(stone: Stone, ice: int) -> Path:
    (x, y), speed, heading, omega = stone
    v = speed * math.cos(heading), speed * math.sin(heading)
    return Path(0.0, Motion(x, y, 0.0, *v, omega), *ICES[ice])


@settings(deadline=None, max_examples=300)
@given(stones, stones, st.integers(0, 2), st.floats(0.0, 2.0))
def test_no_contact_is_missed_and_none_made_up(
    one: Stone, other: Stone, ice: int, start: float
) -> None:
    a, b = path(one, ice), path(other, ice)
    here = a.point(start), b.point(start)
    assume(math.dist(here[0][:2], here[1][:2]) > REACH + 1e-6)
    found = first_contact(a, b, start, here, REACH)
    end = min(found, max(a.stop, b.stop))
    # Dense at first, where stones are fast.
    times = start + max(end - start, 0.0) * np.linspace(0, 1, 1500, endpoint=False) ** 2
    apart = [math.dist(a.point(t)[:2], b.point(t)[:2]) for t in times.tolist()]
    assert min(apart) > REACH - 1e-9
    if found < math.inf:
        assert math.dist(a.point(found)[:2], b.point(found)[:2]) == pytest.approx(REACH, abs=1e-9)
