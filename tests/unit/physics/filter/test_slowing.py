from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import least_squares

from curlshot.data.sheet import GRAVITY
from curlshot.physics.filter.slowing import (
    LONGEST,
    SHARE,
    at_speed,
    course,
    motion,
    power_at,
    power_prior,
    stop_after,
    time_left,
)
from curlshot.physics.ice import FCV1
from curlshot.synthetic.physics import Ice, Start
from curlshot.synthetic.physics import simulate as move

SLOWED = np.array([[0.3, 1.2, -0.12], [0.1, 0.3, -0.03]])


def test_constant_ice_gives_a_parabola_that_ends() -> None:
    tau = np.array([-0.5, 0.0, 2.0, 10.0, 30.0])
    places, _ = course(SLOWED, tau, 0.0)
    ended = np.minimum(tau, 10.0)[:, None]
    expected = SLOWED[:, 0] + ended * SLOWED[:, 1] + ended**2 / 2 * SLOWED[:, 2]
    assert stop_after(SLOWED, 0.0) == pytest.approx(10.0)
    assert places == pytest.approx(expected)


def test_penner_s_ice_stops_a_stone_where_he_says() -> None:
    mu, speed = 0.008, 2.0
    x = np.array([[0.0, 0.0, 0.0], [0.0, speed, -mu * GRAVITY * speed**-0.5]])
    places, _ = course(x, np.array([1e3]), 0.5)
    assert places[0] == pytest.approx([0.0, speed**2.5 / (2.5 * mu * GRAVITY)])
    _, going = motion(x, 5.0, 0.5)
    assert going[1] ** 1.5 == pytest.approx(speed**1.5 - 1.5 * mu * GRAVITY * 5.0)


def test_the_way_of_a_curling_stone_is_followed_to_its_rest() -> None:
    # Its heading turns by a third of a radian; the small-step program knows of no power.
    ice = Ice(b=0.0085, a=0.0027, v_c=0.0639, curl=0.0082)
    glide = move([Start(0.0, 0.0, 0.4, 0.0, 0.0, 1.0)], 4.5, ice=ice, step=5e-4, keep_every=4)
    t = np.arange(0.0, 4.5, 0.02)
    true = glide.at(t)[:, 0, :2]

    def off(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray((course(values[:6].reshape(2, 3), t, values[6])[0] - true).ravel())

    found = least_squares(off, [0.0, 0.4, -0.14, 0.0, 0.0, 0.01, 0.3], x_scale=[0.1] * 7).x
    assert found[[1, 4]] == pytest.approx([0.4, 0.0], abs=5e-4)
    assert np.abs(off(found)).max() < 5e-4


@pytest.mark.parametrize("a", [0.0, 0.05])
def test_a_stone_that_nothing_slows_goes_on(a: float) -> None:
    x = np.array([[0.0, 1.0, a], [0.0, 0.0, 0.0]])
    assert time_left(x) == LONGEST
    place, speed = motion(x, 2.0, 0.25)
    assert place == pytest.approx([2.0 + 2.0 * a, 0.0], abs=1e-3)
    assert speed == pytest.approx([1.0 + 2.0 * a, 0.0], abs=1e-3)


def test_a_deceleration_at_other_speeds_goes_as_fcv1_has_it() -> None:
    """A share of 0.232 of FCV1's friction at 1 m/s fades with the speed."""
    law, speeds = FCV1(), np.array([0.0, 0.1, 0.5, 1.0, 3.0])
    share = law.a / (1 + law.v_c) / (law.a / (1 + law.v_c) + law.b)
    value, sd = at_speed(speeds, float(law.deceleration(1.0)), share, 0.1)
    assert value == pytest.approx(law.deceleration(speeds), rel=0.01)
    most, _ = at_speed(speeds, float(law.deceleration(1.0)), share + 0.1, 0.1)
    assert sd == pytest.approx(np.abs(most - value))


@pytest.mark.parametrize("speed", [0.06, 0.3, 1.0, 3.0])
def test_a_power_is_the_slope_of_fcv1_s_law(speed: float) -> None:
    law = FCV1()
    share = law.a / (1 + law.v_c) / (law.a / (1 + law.v_c) + law.b)
    low, high = np.log(law.deceleration([0.99 * speed, 1.01 * speed]))
    assert power_at(speed, share) == pytest.approx((low - high) / np.log(1.01 / 0.99), rel=0.01)


def test_what_is_known_of_a_power_beforehand_holds_all_laws_of_ice() -> None:
    """Even ice, FCV1's and Penner's lie within it, the last at 3 m/s by a hair."""
    share = float(SHARE.value or 0.0), float(SHARE.stderr or 0.0)
    for speed in (0.1, 0.3, 1.0, 3.0):
        power, sd = power_prior(speed, *share)
        for other in (0.0, float(power_at(speed, 0.232)), 0.5):
            assert abs(power - other) < (3.0 if speed > 1 else 1.5) * sd
        assert sd < 0.35  # of a stone that goes on by a centimetre it tells how fast it was
    assert power_prior(1.0, 0.0, 0.0)[1] < 1e-3  # what is known to be even stays so


def test_ice_that_seems_to_slow_slow_stones_less_still_slows_them() -> None:
    value, _ = at_speed([0.0, 0.02], 0.1, -0.2, 0.1)
    assert ((value > 0.0) & (value < 0.1)).all()
