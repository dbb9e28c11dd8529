"""When two stones meet, against paths sampled densely."""

from __future__ import annotations

import math

import numpy as np
import pytest

from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Penner
from curlshot.physics.simulator.approach import all_crossings, first_contact
from curlshot.physics.simulator.motion import Motion, Path

REACH = 0.291
ICES = ((FCV1(), FCV1Curl()), (Constant(0.01), NoCurl()), (Penner(), FCV1Curl(turn=0.05)))


class Counted(Path):
    """A path that counts how often any of its kind is asked for a place."""

    asked = 0

    def point(self, t: float):  # type: ignore[no-untyped-def]
        Counted.asked += 1
        return super().point(t)


def test_grazes_are_timed_to_a_billionth_of_a_second() -> None:
    """Newton's method goes there slowly: the rate at which stones come nearer is next to none."""
    deep = 10.0 ** -np.arange(2.0, 11.0)
    count, nearest = len(deep), 20.0

    def points(which: np.ndarray, t: np.ndarray) -> np.ndarray:
        """The first ones pass, 1 m/s fast, the others rest."""
        goes, zero = which < count, np.zeros(len(which))
        x, y = np.where(goes, [t - nearest, (REACH - deep)[which % count]], 0.0)
        return np.column_stack([x, y, goes, zero])

    pairs, full = np.arange(count), np.ones(count)
    found = all_crossings(
        points, pairs, pairs + count, (nearest - 0.5) * full, nearest * full, REACH * full
    )
    before = np.sqrt(deep * (2 * REACH - deep))
    np.testing.assert_allclose(found, nearest - before, rtol=0, atol=1e-9)


def test_the_faster_stone_in_front_is_left_alone_at_once() -> None:
    state = [Motion(0, y, 0, 0, speed, 1.0) for y, speed in ((0, 1.0), (0.3, 1.2))]
    a, b = (Counted(0.0, motion, *ICES[1]) for motion in state)
    here = a.point(0.0), b.point(0.0)
    Counted.asked = 0
    assert first_contact(a, b, 0.0, here, REACH) == math.inf
    assert Counted.asked == 2


@pytest.mark.parametrize("speed", [0.3, 1.0])
def test_stones_abreast_are_passed_over_in_a_few_steps(speed: float) -> None:
    """They come nearer by next to nothing, of which the square is zero."""
    state = [Motion(0, 0, 0, 1, 0, 1.0), Motion(0, -1, 0, speed, 1e-170, 1.0)]
    a, b = (Counted(0.0, motion, *ICES[1]) for motion in state)
    here = a.point(0.0), b.point(0.0)
    Counted.asked = 0
    assert first_contact(a, b, 0.0, here, REACH) == math.inf
    assert Counted.asked < 100


def test_a_search_ends_with_its_time() -> None:
    """On next to no friction stones go on for an hour, which a fit of two seconds need not know."""
    laws = Constant(1e-5), FCV1Curl()
    goes = Counted(0.0, Motion(0, 1.8, 0, -0.1, -0.25, 1.0), *laws)
    lies = Counted(0.0, Motion(0, 0, 0, 0, 0, 0), *laws)
    here = goes.point(0.0), lies.point(0.0)
    Counted.asked = 0
    assert first_contact(goes, lies, 0.0, here, REACH, until=2.0) == math.inf
    assert Counted.asked < 60
    meeting = Path(0.0, Motion(0, 1.8, 0, 0, -0.25, 0.0), *laws)
    here = meeting.point(0.0), lies.point(0.0)
    met = first_contact(meeting, lies, 0.0, here, REACH)
    assert first_contact(meeting, lies, 0.0, here, REACH, until=met + 0.1) == met
    assert first_contact(meeting, lies, 0.0, here, REACH, until=met - 0.1) > met - 0.1
