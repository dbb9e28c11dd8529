"""The independent physics against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from curlshot.synthetic.physics import GRAVITY, RADIUS, Ice, Impact, Start, collide, simulate

speeds = st.floats(-3, 3)
spins = st.floats(-4, 4)


@pytest.mark.parametrize(("speed", "mu"), [(0.4, 0.0109), (2.0, 0.007), (3.0, 0.015)])
def test_glide_ends_where_the_closed_form_says(speed: float, mu: float) -> None:
    stop = speed / (mu * GRAVITY)
    motion = simulate([Start(0, 0, vx=0.6 * speed, vy=0.8 * speed)], stop + 0.1, ice=Ice(b=mu))
    x, y = motion.at(stop + 0.05)[0, :2]
    way = speed**2 / (2 * mu * GRAVITY)
    assert np.allclose([x, y], [0.6 * way, 0.8 * way], atol=1e-6)
    half = motion.at(stop / 2)[0]
    assert np.hypot(half[3], half[4]) == pytest.approx(speed / 2, abs=1e-5)


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


@given(speeds, speeds, spins, spins, st.floats(0, 6.28), st.floats(0, 1), st.floats(0, 1))
def test_impact_keeps_what_must_be_kept(
    vx: float, vy: float, w1: float, w2: float, angle: float, e: float, mu: float
) -> None:
    n = (float(np.cos(angle)), float(np.sin(angle)))
    closing = vx * n[0] + vy * n[1]
    if closing <= 0:
        return
    impact = Impact(e, mu)
    first, second = collide((vx, vy, w1), (0, 0, w2), n, impact)
    assert np.allclose(np.add(first, second)[:2], [vx, vy], atol=1e-12)
    parting = (second[0] - first[0]) * n[0] + (second[1] - first[1]) * n[1]
    assert parting == pytest.approx(e * closing, abs=1e-12)
    inertia = impact.inertia * RADIUS**2

    def about_contact_start(a: tuple[float, ...], b: tuple[float, ...]) -> float:
        lever = 2 * RADIUS * (n[0] * b[1] - n[1] * b[0])  # second stone's place seen from first
        return inertia * (a[2] + b[2]) + lever

    before = about_contact_start((vx, vy, w1), (0.0, 0.0, w2))
    assert about_contact_start(first, second) == pytest.approx(before, abs=1e-10)

    def energy(*stones: tuple[float, float, float]) -> float:
        return sum(s[0] ** 2 + s[1] ** 2 + inertia * s[2] ** 2 for s in stones)

    assert energy(first, second) <= energy((vx, vy, w1), (0.0, 0.0, w2)) + 1e-9


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
