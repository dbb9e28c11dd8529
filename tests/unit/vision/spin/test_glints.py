from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.vision.spin.align import ORDERS
from curlshot.vision.spin.glints import SPINS, _likely, _solved, course, unlit
from curlshot.vision.spin.handle import cap_spectrum, handle_angles

RAYS = 64
RADII = np.linspace(0.012, 0.09, 8)
TIMES = np.arange(75) / 25


def lit(turn: float, lamp: tuple[float, float], bright: float) -> NDArray[np.complex64]:
    """A dark cap with a slightly paler bar, and a lamp mirrored on it somewhere."""
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    x, y = RADII * np.cos(angle), RADII * np.sin(angle)
    aside, along = y * np.cos(turn) - x * np.sin(turn), x * np.cos(turn) + y * np.sin(turn)
    bar = 1 / (1 + np.exp((np.abs(aside) - 0.012) / 0.003)) / (1 + np.exp((-along - 0.05) / 0.003))
    far = (x - lamp[0]) ** 2 + (y - lamp[1]) ** 2
    value = 50 + 30 * bar + bright * np.exp(-far / 0.02**2)
    return cap_spectrum(np.repeat(value[..., None], 3, -1).astype(np.uint8), RADII)


def lamp(t: float) -> tuple[float, float]:
    """Where it is mirrored: it wanders over the cap as the stone goes on, m."""
    return 0.04, 0.05 - 0.02 * t


def pictures(spin: float, bright: float) -> NDArray[np.complex64]:
    return np.array([lit(spin * t, lamp(t), bright) for t in TIMES])


@pytest.mark.parametrize("spin", [-1.6, 0.8])
def test_a_lamp_mirrored_on_a_cap_does_not_hold_its_angle(spin: float) -> None:
    seen = pictures(spin, 150.0)
    angles = handle_angles(TIMES, list(seen), RADII, np.full(len(TIMES), 0.0005))
    theta, sd = angles.theta, angles.sd
    told = np.isfinite(theta)
    assert told.mean() > 0.8
    slope = np.polyfit(TIMES[told], theta[told], 1)[0]
    assert slope == pytest.approx(spin, abs=0.03)
    off = theta[told] - spin * TIMES[told]
    assert (np.abs(off - np.median(off)) < 2 * sd[told]).mean() > 0.9


@pytest.mark.parametrize("missing", [range(5, 12), range(20, 27), range(10, 25)])
def test_nor_does_it_where_pictures_are_missing(missing: range) -> None:
    """The angle that follows the lamp turns a little, too: two radians less than the cap."""
    seen = [None if k in missing else one for k, one in enumerate(pictures(0.8, 150.0))]
    angles = handle_angles(TIMES, seen, RADII, np.full(len(TIMES), 0.0005))
    theta, sd = angles.theta, angles.sd
    off = (theta - 0.8 * TIMES)[told := np.isfinite(theta)]
    assert told.mean() > 0.6
    assert (np.abs(off - np.median(off)) < 3 * sd[told]).mean() > 0.9


def test_spins_are_told_from_stretch_to_stretch_whatever_light_is_on_a_cap() -> None:
    spins = np.where(TIMES < 1.5, 1.4, -0.9)
    turns = np.concatenate([[0.0], np.cumsum(spins[1:] * np.diff(TIMES))])
    seen = [lit(a, lamp(t), 150.0) for a, t in zip(turns, TIMES, strict=True)]
    told = np.gradient(course(TIMES, np.array(seen))[0], TIMES)
    assert np.abs(told - spins)[(TIMES < 1.0) | (TIMES > 2.0)].max() < 0.25


def test_a_cap_that_comes_to_rest_in_a_light_tells_no_angle_more() -> None:
    still = np.minimum(TIMES, 1.5)
    seen = [lit(1.4 * t, lamp(t), 150.0) for t in still]
    angles = handle_angles(TIMES, seen, RADII, np.full(len(TIMES), 0.0005))
    theta, sd = angles.theta, angles.sd
    off = (theta - 1.4 * still)[told := np.isfinite(theta)]
    assert 0.45 < told.mean() < 0.65
    assert (np.abs(off - np.median(off)) < 3 * sd[told]).all()


@pytest.mark.parametrize(("stretches", "expected"), [(1, 1.0), (4, 3.0)])
def test_a_spin_that_explains_little_more_in_one_stretch_is_none(
    stretches: int, expected: float
) -> None:
    shares = np.zeros((9, len(SPINS)))
    shares[:, np.abs(SPINS - 1.0) < 1e-6] = 0.5
    shares[3 : 3 + stretches, np.abs(SPINS - 3.0) < 1e-6] = 0.7
    spins = _likely(shares)
    np.testing.assert_allclose(spins[3 : 3 + stretches], expected)
    np.testing.assert_allclose(np.delete(spins, slice(3, 3 + stretches)), 1.0)


@pytest.mark.parametrize(("odds", "expected"), [(0.04, 0.0), (0.06, 1.0)])
def test_a_spin_that_is_hardly_more_probable_than_its_opposite_is_none(
    odds: float, expected: float
) -> None:
    each = np.zeros((9, len(SPINS)))
    each[:, np.abs(SPINS - 1.0) < 1e-6] = odds
    np.testing.assert_allclose(_likely(each), expected)


def patterns(*along: NDArray[np.float64]) -> NDArray[np.complex64]:
    """A cap whose harmonics change in time as these say, each by its own pattern of rings."""
    rng = np.random.default_rng(6)
    shape = len(ORDERS), 2, 3
    shown = [rng.normal(size=shape) + 1j * rng.normal(size=shape) for _ in along]
    seen = [one[:, :, None, None] * cap for one, cap in zip(along, shown, strict=True)]
    return np.asarray(sum(seen), np.complex64)


def test_what_comes_and_goes_on_a_cap_without_turning_has_no_spin() -> None:
    """Either way round a spin explains as much of it, and more than no spin does."""
    flicker = np.cos(1.6 * np.outer(TIMES, ORDERS))
    assert not course(TIMES, patterns(flicker))[0].any()


def test_of_a_cap_that_turns_and_shows_nothing_else_the_spin_is_told() -> None:
    turning = np.exp(-1.6j * np.outer(TIMES, ORDERS))
    angles, share = course(TIMES, patterns(turning))
    np.testing.assert_allclose(angles, 1.6 * TIMES, atol=1e-6)
    assert share > 0.9


def faint(seed: int) -> list[NDArray[np.complex64]]:
    """A cap whose handle is lost in the grain of each picture, turning by -1.6 rad/s."""
    rng = np.random.default_rng(seed)
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    x, y = RADII * np.cos(angle), RADII * np.sin(angle)
    seen = []
    for turn in -1.6 * TIMES:
        aside, along = y * np.cos(turn) - x * np.sin(turn), x * np.cos(turn) + y * np.sin(turn)
        grain = cv2.GaussianBlur(rng.normal(0, 1, x.shape), (0, 0), 1.5)
        value = 120 + 26 * ((np.abs(aside) < 0.012) & (along > -0.05)) + 12 * grain / grain.std()
        seen.append(cap_spectrum(np.repeat(value[..., None], 3, -1).astype(np.uint8), RADII))
    return seen


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_faint_handle_that_noise_hides_in_each_picture_is_told_by_all_of_them(seed: int) -> None:
    angles = handle_angles(TIMES, faint(seed), RADII, np.full(len(TIMES), 0.0005))
    theta, sd = angles.theta, angles.sd
    told = np.isfinite(theta)
    assert told.mean() > 0.5
    assert np.polyfit(TIMES[told], theta[told], 1)[0] == pytest.approx(-1.6, abs=0.06)
    assert np.nanmedian(sd) > 0.2


def test_pictures_too_few_for_a_spin_have_no_course() -> None:
    assert not course(TIMES[:5], pictures(1.6, 150.0)[:5])[0].any()


def test_light_is_taken_from_pictures_and_what_turns_is_left() -> None:
    seen, dark = pictures(1.6, 150.0), pictures(1.6, 0.0)
    parted = unlit(TIMES, seen, 1.6 * TIMES)
    inner = np.s_[:, 3:-1]  # the light has most of what turns slowly
    before = np.sum(np.abs(seen - dark)[inner] ** 2)
    assert np.sum(np.abs(parted.pictures - dark)[inner] ** 2) < 0.1 * before
    assert parted.share > 0.5 > 0.1 > unlit(TIMES, seen, 0.0 * TIMES).share
    assert parted.told.min() > 0.1 and unlit(TIMES, seen, 0.0 * TIMES).told.max() < 0.1


def test_light_along_straight_lines_between_knots_leaves_nothing_in_a_long_clip() -> None:
    rng = np.random.default_rng(4)
    times = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 24.0, 600)), [24.0]])
    shape = len(ORDERS), 2, 3
    at_knots = rng.normal(size=(61, *shape)) + 1j * rng.normal(size=(61, *shape))
    cap = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    before = np.minimum((times / 0.4).astype(int), 59)
    part = (times / 0.4 - before)[:, None, None, None]
    light = (1 - part) * at_knots[before] + part * at_knots[before + 1]
    turning = np.exp(-1j * ORDERS * 1.5 * times[:, None])[..., None, None] * cap
    found = unlit(times, np.asarray(light + turning, np.complex64), 1.5 * times)
    left = np.abs(found.pictures - turning)[:, 3:]
    assert left.mean() < 0.1 * np.abs(turning).mean()
    assert found.share > 0.9


def test_a_system_is_solved_in_parts_as_in_one() -> None:
    rng = np.random.default_rng(3)
    matrix = np.eye(40) * 9 + rng.normal(size=(40, 40))
    values = rng.normal(size=(40, 17, 51, 2)).astype(np.float32).view(np.complex64)[..., 0]
    whole = np.linalg.solve(matrix, values.reshape(40, -1)).reshape(values.shape)
    np.testing.assert_allclose(_solved(matrix, values), whole, rtol=0, atol=1e-7)
