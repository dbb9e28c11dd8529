from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.filter.slowing import motion
from curlshot.physics.local_fit.constraints import (
    DISTANCE_SD,
    DOUBT,
    acceleration_prior,
    contact_constraints,
)
from curlshot.physics.local_fit.solution import Deceleration, Meeting
from curlshot.tests.helpers.physics.watch import RADIUS

RANKS = ((0, 1), (2, 3))
"""Pieces of the first and of the second stone, before and after the hit."""

ORIGINS = np.array([0.0, 1.0, 0.2, 1.1])
AT = 24
"""Where the time of the hit stands among the unknowns of four pieces."""


def unknowns(distance: float = 2 * RADIUS) -> np.ndarray:
    """Two stones that meet at 1 s at a distance, with motions that do not quite fit."""
    rng = np.random.default_rng(5)
    powers = rng.uniform(0, 0.5, 4)
    theta = np.concatenate([rng.normal(0, 0.1, 24), [1.0], powers])
    theta[[1, 4]], theta[[13, 16]] = (0.1, 1.5), (0.05, -0.4)
    for rank, y in zip((0, 1, 2, 3), (-distance, -distance, 0.0, 0.0), strict=True):
        tau = 1.0 - ORIGINS[rank]
        x = theta[6 * rank : 6 * rank + 6].reshape(2, 3)
        x[:, 0] += [0.0, y] - motion(x, tau, powers[rank])[0]
    return theta


def constraints(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    meeting = Meeting(1.0, ("A", "B"), 0.02)
    return contact_constraints(theta, AT, ORIGINS, meeting, RANKS, RADIUS, np.array([1.0, 1.2]))


def test_constraints_are_differentiated_right() -> None:
    theta = unknowns()
    rows, _, _ = constraints(theta)
    for k in range(len(theta)):
        ends = []
        for sign in (1.0, -1.0):
            moved = theta.copy()
            moved[k] += sign * 1e-6
            ends.append(constraints(moved)[1])
        assert rows[:, k] == pytest.approx((ends[0] - ends[1]) / 2e-6, rel=1e-4, abs=1e-5), k


def test_momentum_stays_where_masses_are_known() -> None:
    theta, masses = unknowns(), np.array([1.0, 1.2])
    meeting = Meeting(1.0, ("A", "B"), 0.02)
    without = contact_constraints(theta, AT, ORIGINS, meeting, RANKS, RADIUS, None)
    _, values, _ = constraints(theta)
    assert len(without[1]) == len(values) - 2
    speeds = [
        motion(theta[6 * k : 6 * k + 6].reshape(2, 3), 1.0 - ORIGINS[k], theta[25 + k])[1]
        for k in range(4)
    ]
    change = np.array([speeds[1] - speeds[0], speeds[3] - speeds[2]])
    assert values[-2:] == pytest.approx(masses @ change / masses.mean())


def test_a_distance_that_is_off_has_less_of_a_say() -> None:
    usual, _, sd = (part[5] for part in constraints(unknowns()))
    assert usual[24] != 0.0
    assert sd == pytest.approx(DISTANCE_SD * 2 * RADIUS)
    off = 3 * DOUBT * DISTANCE_SD
    _, value, wide = (part[5] for part in constraints(unknowns(2 * RADIUS * (1 + off))))
    assert value == pytest.approx(2 * RADIUS * off)
    assert wide == pytest.approx(sd * np.sqrt(1 + 3**2))


def test_paths_join_however_far_they_are_apart() -> None:
    theta = unknowns()
    apart = theta.copy()
    apart[6] += 0.5  # the path of the first stone after the hit, in x
    _, values, sd = constraints(apart)
    assert values[1] == pytest.approx(0.5)
    assert np.array_equal(sd[:5], constraints(theta)[2][:5])


@pytest.mark.parametrize("speed", [(0.0, 2.0), (-1.2, 1.6)])
def test_ice_slows_against_the_motion(speed: tuple[float, float]) -> None:
    precision, mean = acceleration_prior(np.array(speed), Deceleration(0.1, 0.05, 0.02))
    along = np.array(speed) / np.hypot(*speed)
    assert mean == pytest.approx(-0.1 * along)
    assert along @ precision @ along == pytest.approx(0.05**-2)
    assert np.linalg.det(precision) == pytest.approx(0.05**-2 * 0.02**-2)


def test_of_slow_stones_less_is_known() -> None:
    prior = Deceleration(0.1, 0.01, 0.01)
    known = [acceleration_prior(np.array([0.0, v]), prior)[0][1, 1] for v in (0.01, 0.1, 0.5, 2.0)]
    assert known == sorted(known)
    assert np.all(acceleration_prior(np.array([0.0, 0.01]), prior)[1] == 0)
