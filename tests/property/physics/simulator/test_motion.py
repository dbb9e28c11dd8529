from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.data.sheet import GRAVITY
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import Constant, IceLaw, Penner
from curlshot.physics.simulator.motion import Motion, Path
from curlshot.tests.helpers.physics.motion import LAWS, along_y

CURLS = [NoCurl(), FCV1Curl()]
speeds = st.floats(0.01, 6.0)
angles = st.floats(-math.pi, math.pi)
spins = st.floats(-6.0, 6.0)


@settings(deadline=None)
@given(speeds, st.floats(0.002, 0.05), st.floats(0.0, 1.0))
def test_constant_friction_has_its_closed_form(v: float, mu: float, part: float) -> None:
    path = Path(3.0, along_y(v), Constant(mu), NoCurl())
    a = mu * GRAVITY
    assert path.stop - 3.0 == pytest.approx(v / a, rel=1e-12)
    assert path.length == pytest.approx(v**2 / (2 * a), rel=1e-12)
    t = part * v / a
    assert path.at(3.0 + t).y == pytest.approx(v * t - a * t**2 / 2, abs=1e-11)
    assert path.at(3.0 + t).vy == pytest.approx(v - a * t, abs=1e-12)


@settings(deadline=None)
@given(speeds, st.floats(0.0, 1.0))
def test_penner_has_its_closed_form(v: float, part: float) -> None:
    path = Path(0.0, along_y(v), Penner(), NoCurl())
    a = 0.008 * GRAVITY
    stop = v**1.5 / (1.5 * a)
    assert path.stop == pytest.approx(stop, rel=1e-10, abs=1e-8)
    assert path.length == pytest.approx(v**2.5 / (2.5 * a), abs=1e-8)
    left = v**1.5 - 1.5 * a * part * stop
    assert path.at(part * stop).vy ** 1.5 == pytest.approx(left, abs=1e-9)


@settings(deadline=None)
@given(speeds, angles, spins, st.sampled_from(LAWS), st.sampled_from(CURLS), st.floats(0.05, 0.95))
def test_a_path_taken_up_again_is_the_same_path(
    v: float,
    angle: float,
    omega: float,
    law: IceLaw,
    curl: NoCurl | FCV1Curl,
    part: float,
) -> None:
    start = Motion(0.4, -1.0, 0.2, v * math.cos(angle), v * math.sin(angle), omega)
    path = Path(0.0, start, law, curl)
    assert path.at(0.0) == start
    assert path.at(1e-12) == pytest.approx(start, abs=1e-9)
    t = part * path.stop
    again = Path(t, path.at(t), law, curl)
    assert again.stop == pytest.approx(path.stop, abs=1e-9)
    for later in (t, (t + path.stop) / 2, path.rest + 1):
        assert again.at(later)[:2] == pytest.approx(path.at(later)[:2], abs=1e-8)
        assert again.at(later)[2:] == pytest.approx(path.at(later)[2:], abs=1e-6)


@settings(deadline=None)
@given(speeds, spins, st.sampled_from(LAWS), angles, st.floats(0.0, 1.0))
def test_mirror_and_rotation(
    v: float, omega: float, law: IceLaw, angle: float, part: float
) -> None:
    path = Path(0.0, Motion(0.0, 0.0, 0.0, 0.0, v, omega), law, FCV1Curl())
    mirrored = Path(0.0, Motion(0.0, 0.0, 0.0, 0.0, v, -omega), law, FCV1Curl())
    c, s = math.cos(angle), math.sin(angle)
    rotated = Path(0.0, Motion(0.0, 0.0, 0.0, -s * v, c * v, omega), law, FCV1Curl())
    t = part * path.stop
    one, two, three = path.at(t), mirrored.at(t), rotated.at(t)
    assert (two.x, two.y, two.theta) == pytest.approx((-one.x, one.y, -one.theta), abs=1e-9)
    turned = (c * one.x - s * one.y, s * one.x + c * one.y, one.theta)
    assert (three.x, three.y, three.theta) == pytest.approx(turned, abs=1e-9)


@settings(deadline=None)
@given(speeds, spins, st.sampled_from(LAWS), st.sampled_from(CURLS))
def test_places_at_many_times_are_those_at_each(
    v: float, omega: float, ice: IceLaw, curl: FCV1Curl | NoCurl
) -> None:
    path = Path(2.0, Motion(1.0, -3.0, 0.0, 0.6 * v, 0.8 * v, omega), ice, curl)
    times = np.linspace(2.0, path.stop + 1.0, 40)
    each = [path.point(t)[:2] for t in times.tolist()]
    np.testing.assert_array_equal(path.places(times), each)
