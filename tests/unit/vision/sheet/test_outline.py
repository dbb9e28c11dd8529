from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from curlshot.vision.sheet.outline import HALF_WAY, find_edge

STEP = 0.375
X = STEP * (np.arange(33) - 16)


def profile(edge: float, width: float, depth: float, blur: float, x: np.ndarray = X) -> np.ndarray:
    """Ice, a line of this width and so much darker than the paint, and paint."""
    rise = (1 + depth) * ndtr((x - edge) / blur) - depth * ndtr((x - edge - width) / blur)
    return np.asarray(rise - 0.5)


@pytest.mark.parametrize("blur", [0.6, 0.9, 1.4])
@pytest.mark.parametrize("edge", [-0.2, 0.0, 0.15])
def test_a_bare_edge_is_crossed_half_way(edge: float, blur: float) -> None:
    found = find_edge(profile(edge, 1.0, 0.0, blur), STEP)
    assert found.level == pytest.approx(0.0, abs=0.02)
    assert found.sd < 0.3


@pytest.mark.parametrize(
    ("width", "depth"), [(1.0, 0.6), (2.0, 0.3), (2.5, 0.8), (2.4, -0.36), (2.0, -0.5), (2.4, -0.7)]
)
def test_an_outline_belongs_to_the_paint(width: float, depth: float) -> None:
    rng = np.random.default_rng(3)
    edge = 0.4
    noisy = profile(edge, width, depth, 0.9) + rng.normal(0, 0.005, len(X))
    half_way = np.interp(0.0, noisy[12:19], X[12:19])
    found = np.interp(find_edge(noisy, STEP).level, noisy[12:19], X[12:19])
    assert abs(found - edge) < 0.15
    assert abs(found - edge) < 0.5 * abs(half_way - edge)


@pytest.mark.parametrize("off", [-1.2, 0.9, 1.6])
def test_where_a_profile_was_expected_to_rise_tells_nothing_of_its_line(off: float) -> None:
    # Paint, a line of middle grey and ice, and colours that are coded at half the resolution.
    grey = 0.7 * profile(off, 2.4, -0.36, 0.75) + 0.3 * profile(off - 1.0, 2.4, -0.6, 1.6)
    found = float(np.interp(find_edge(grey, STEP).level, grey, X))
    centred = 0.7 * profile(0.0, 2.4, -0.36, 0.75) + 0.3 * profile(-1.0, 2.4, -0.6, 1.6)
    usual = float(np.interp(find_edge(centred, STEP).level, centred, X))
    assert found - off == pytest.approx(usual, abs=0.15)


@pytest.mark.parametrize(("left", "told"), [(3, False), (5, True)])
def test_no_line_is_told_from_a_profile_that_ends_at_the_edge(left: int, told: bool) -> None:
    cut = profile(0.0, 1.2, 0.6, 0.9)
    cut[17 + left :] = np.nan
    assert (find_edge(cut, STEP) != HALF_WAY) == told


@pytest.mark.parametrize("depth", [0.6, -0.3])
def test_in_a_pan_the_edge_stays_where_it_is_at_rest(depth: float) -> None:
    rest = find_edge(profile(0.0, 1.2, depth, 0.9), STEP)
    wide = STEP * (np.arange(120) - 60)
    passed = [profile(shift, 1.2, depth, 0.9, wide) for shift in np.linspace(-4.5, 4.5, 60)]
    blurred = np.mean(passed, axis=0)
    crossed = float(np.interp(rest.level, blurred[40:80], wide[40:80]))
    slope = float(np.interp(crossed, wide, np.gradient(blurred, wide)))
    assert abs(crossed) > 0.5
    assert abs(crossed - rest.beyond(np.array(slope))) < 0.6 * abs(crossed)
    at_rest = rest.beyond(np.array(0.5))
    assert abs(at_rest) < 0.02


@pytest.mark.parametrize(("width", "blur"), [(1.5, 0.7), (2.6, 0.9), (4.0, 1.2)])
def test_the_edge_of_an_outline_alone_is_its_outer_side(width: float, blur: float) -> None:
    share = ndtr((X + width / 2) / blur) - ndtr((X - width / 2) / blur)
    found = find_edge(share / share.max() - 0.5, STEP)
    assert found.level == 0.0
    assert found.within == pytest.approx(width / 2, abs=0.3)
    assert abs(found.within - width / 2) < 2 * found.sd


def test_a_line_that_may_be_of_the_ice_makes_the_edge_less_sure() -> None:
    found = find_edge(profile(0.0, 2.0, -0.7, 1.1), STEP)
    assert found.sd > 0.3
    assert found.sd > 3 * find_edge(profile(0.0, 2.0, 0.0, 1.1), STEP).sd


@pytest.mark.parametrize("depth", [-0.7, -0.5, 0.6])
def test_single_profiles_that_are_less_steep_lie_where_their_mean_does(depth: float) -> None:
    line = profile(0.0, 2.4, depth, 0.6)
    found = find_edge(line, STEP)
    slope = np.interp(0.0, X, np.gradient(line, X))
    assert found.beyond(0.8 * slope) == pytest.approx(0.0, abs=0.05)


def test_too_little_of_a_profile_tells_nothing() -> None:
    assert find_edge(np.full(33, np.nan), STEP).level == 0.0


def test_a_line_makes_the_edge_less_sure_and_none_looked_at_least() -> None:
    bare, lined = (find_edge(profile(0.0, 1.2, depth, 0.9), STEP) for depth in (0.0, 0.6))
    assert bare.sd < 0.1
    assert bare.sd < 0.5 * lined.sd
    assert bare.sd < find_edge(np.full(33, np.nan), STEP).sd
