"""The independent physics against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from curlshot.synthetic.physics import GRAVITY, RADIUS, Ice, Start, simulate


def test_spin_falls_steadily_and_stops() -> None:
    motion = simulate([Start(0, 0, vy=1.0, omega=-2.0)], 3.0, ice=Ice(spin_decay=0.1))
    assert motion.at(2.0)[0, 5] == pytest.approx(-1.8, abs=1e-6)
    assert motion.at(2.0)[0, 2] == pytest.approx(-3.8, abs=1e-6)


def test_curl_goes_to_the_side_of_the_spin() -> None:
    ice = Ice(curl=0.0082)
    left = simulate([Start(0, 0, vy=2.0, omega=1.5)], 4.0, ice=ice).at(4.0)[0]
    right = simulate([Start(0, 0, vy=2.0, omega=-1.5)], 4.0, ice=ice).at(4.0)[0]
    assert left[0] < -0.02
    assert np.allclose(left[:2] * [-1, 1], right[:2])


def test_an_exposure_that_begins_before_the_first_time_is_of_a_stone_on_its_way() -> None:
    motion = simulate([Start(0, 0, vx=-0.3, vy=1.2, omega=1.0)], 1.0)
    early, late = motion.at([-0.005, 0.005])[:, 0]
    assert np.allclose((early + late)[:3] / 2, 0, atol=1e-5)
    assert early[1] == pytest.approx(-0.006, abs=1e-5)


def test_stones_meet_at_two_radii() -> None:
    speed, mu, gap, aside = 1.4, 0.0109, 0.5, 0.1
    starts = [Start(0, 0, vy=speed), Start(aside, gap + np.sqrt(4 * RADIUS**2 - aside**2))]
    motion = simulate(starts, 1.0, ice=Ice(b=mu))
    slowing = mu * GRAVITY
    when = (speed - np.sqrt(speed**2 - 2 * slowing * gap)) / slowing
    (hit,) = motion.hits
    assert hit.t == pytest.approx(when, abs=1e-6)
    assert hit.normal[0] == pytest.approx(aside / (2 * RADIUS), abs=1e-5)
    apart = motion.states[:, 1, :2] - motion.states[:, 0, :2]
    assert np.hypot(*apart.T).min() > 2 * RADIUS - 1e-6
