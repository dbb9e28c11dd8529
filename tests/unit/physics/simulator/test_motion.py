from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from curlshot.data.sheet import SHEET
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, IceLaw, Penner
from curlshot.physics.simulator.motion import Motion, Path
from curlshot.tests.helpers.physics.motion import LAWS, along_y


@pytest.mark.parametrize(
    ("law", "seconds"), [(FCV1(), 13.8), (Penner(), 14.05), (Constant(0.0105), 12.3)]
)
def test_draw_to_the_tee_takes_as_long_as_on_real_ice(law: IceLaw, seconds: float) -> None:
    hog_to_hog = 21.945
    whole = hog_to_hog + SHEET.hog_line

    def glide(speed: float) -> Path:
        return Path(0.0, along_y(speed), law, NoCurl())

    path = glide(brentq(lambda v: glide(v).length - whole, 1.0, 4.0))
    time = brentq(lambda t: path.at(t).y - hog_to_hog, 0.0, path.stop)
    assert time == pytest.approx(seconds, abs=0.05)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("omega", [1.5, -0.4, 0.0, 5.0])
def test_path_solves_the_equations_of_motion(law: IceLaw, omega: float) -> None:
    curl = FCV1Curl()
    path = Path(0.0, Motion(1.0, -2.0, 0.3, 0.6, 1.9, omega), law, curl)
    sense = float(np.sign(omega))

    def rates(_: float, state: np.ndarray) -> list[float]:
        _, _, _, v, heading, w = state
        spinning = sense if w * sense > 0 else 0.0
        return [
            v * math.cos(heading),
            v * math.sin(heading),
            w,
            -float(law.deceleration(v)),
            spinning * float(curl.turn_rate(v)),
            -spinning * float(curl.spin_loss(v)),
        ]

    def spin_ends(_: float, state: np.ndarray) -> float:
        return float(state[5] * sense)

    spin_ends.terminal = sense != 0  # type: ignore[attr-defined]
    start = [1.0, -2.0, 0.3, math.hypot(0.6, 1.9), math.atan2(1.9, 0.6), omega]
    end = path.stop - 0.05
    run = solve_ivp(
        rates, (0, end), start, rtol=1e-11, atol=1e-12, events=spin_ends, dense_output=True
    )
    for t in np.linspace(0.0, run.t[-1], 9):
        x, y, theta, v, heading, w = run.sol(t)
        expected = (x, y, theta, v * math.cos(heading), v * math.sin(heading), w)
        assert path.at(float(t)) == pytest.approx(expected, abs=2e-7)


def test_without_spin_left_a_stone_goes_straight() -> None:
    path = Path(0.0, along_y(2.0, 0.1), FCV1(), FCV1Curl())
    times = np.linspace(0.0, path.stop - 1e-6, 400)
    states = [path.at(float(t)) for t in times]
    spun = np.array([s.omega for s in states])
    heading = np.array([math.atan2(s.vy, s.vx) for s in states])
    assert (spun >= 0).all()
    ended = int(np.flatnonzero(spun == 0)[0])
    assert 0 < ended < 399
    assert np.diff(heading[:ended]).min() > 0
    assert np.ptp(heading[ended:]) < 1e-12
    assert np.ptp([s.theta for s in states[ended:]]) == 0


def test_spin_that_is_left_turns_the_stone_on_the_spot() -> None:
    path = Path(0.0, along_y(0.5, 6.0), FCV1(), FCV1Curl())
    assert path.rest > path.stop
    before, after = path.at(path.stop), path.at(path.rest + 1)
    assert (before.x, before.y) == (after.x, after.y)
    assert before.omega > 0
    assert after.omega == 0
    assert after.theta - before.theta == pytest.approx(before.omega**2 / 2 / 25.0, rel=1e-9)


def test_without_a_law_the_spin_ends_with_the_glide() -> None:
    path = Path(0.0, along_y(0.5, 2.0), Constant(), NoCurl())
    assert path.at(path.stop - 1e-9).omega == 2.0
    assert path.at(path.stop).omega == 0.0
    assert path.at(1e6).theta == pytest.approx(2.0 * path.stop, rel=1e-12)


def test_stone_at_rest_stays_at_rest() -> None:
    state = Motion(1.0, 2.0, 3.0, 0.0, 0.0, 0.0)
    path = Path(5.0, state, FCV1(), FCV1Curl())
    assert path.stop == path.rest == 5.0
    assert path.at(5.0) == path.at(50.0) == state


def test_numbers_of_numpy_are_numbers() -> None:
    """As of a stone whose spin comes from a radius that was measured, an array's mean."""
    start = Motion(0.0, 0.0, 0.3, 0.2, 1.5, -0.8)
    same = Motion(*map(np.float64, start))
    paths = [Path(0.0, motion, FCV1(), FCV1Curl()) for motion in (start, same)]
    assert paths[0].at(2.0) == paths[1].at(2.0)
