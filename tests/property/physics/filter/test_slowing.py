from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from curlshot.physics.filter.slowing import (
    change_by,
    motion,
    motion_state,
    stop_after,
)

POWERS = st.floats(0.0, 0.8)
SLOWED = np.array([[0.3, 1.2, -0.12], [0.1, 0.3, -0.03]])
BENT = np.array([[0.3, 1.2, -0.14], [0.1, 0.3, 0.05]])
MOTIONS = st.sampled_from([SLOWED, BENT])


@given(MOTIONS, POWERS, st.floats(-0.5, 0.95))
def test_slopes_are_those_of_places_and_velocities(
    start: NDArray[np.float64], power: float, share: float
) -> None:
    tau = share * stop_after(start, power)
    now = motion_state(start, tau, power)
    for k in range(7):
        ends = []
        for sign in (1.0, -1.0):
            x, p = start.copy(), power
            if k < 6:
                x[divmod(k, 3)] += sign * 1e-6
            else:
                p += sign * 1e-6
            ends.append(motion(x, tau, p))
        (place, speed), (other_place, other_speed) = ends
        assert now.by_place[:, k] == pytest.approx((place - other_place) / 2e-6, abs=1e-4, rel=1e-4)
        assert now.by_speed[:, k] == pytest.approx((speed - other_speed) / 2e-6, abs=1e-4, rel=1e-4)


@given(POWERS, st.floats(0.05, 0.95))
def test_velocity_is_that_of_places_and_acceleration_that_of_velocity(
    power: float, share: float
) -> None:
    tau, step = share * stop_after(BENT, power), 1e-4
    now = motion_state(BENT, tau, power)
    (before, slow), (after, fast) = (motion(BENT, tau + s * step, power) for s in (-1, 1))
    assert now.speed == pytest.approx((after - before) / (2 * step), abs=1e-6)
    assert now.change == pytest.approx((fast - slow) / (2 * step), abs=1e-5)
    ways = np.array([change_by(tau, BENT, power, way) for way in np.eye(2)])
    assert now.change == pytest.approx(ways @ BENT[:, 2])


@given(POWERS, st.floats(0.05, 0.95))
def test_deceleration_is_a_power_of_the_speed(power: float, share: float) -> None:
    now = motion_state(SLOWED, share * stop_after(SLOWED, power), power)
    slower = float(np.hypot(*now.speed) / np.hypot(*SLOWED[:, 1]))
    ratio = float(np.hypot(*now.change) / np.hypot(*SLOWED[:, 2]))
    assert ratio == pytest.approx(slower**-power)
