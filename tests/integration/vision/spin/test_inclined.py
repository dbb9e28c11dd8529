from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.handles import RADII
from curlshot.tests.helpers.vision.inclined import SD, SLANTS, spoilt, told
from curlshot.tests.helpers.vision.steep_handles import TIMES, TRUE, pictures, spin_off, turning
from curlshot.vision.spin.align import Complex, align
from curlshot.vision.spin.handle import handle_angles
from curlshot.vision.spin.inclined import ASLANT, inclined, rise_of_handle


@pytest.mark.parametrize("ring", [0, 3, len(RADII) - 1])
def test_a_ring_that_is_not_seen_spoils_no_other(ring: int) -> None:
    shown = pictures(0.4, SLANTS)
    whole = inclined(shown, TRUE, RADII, SLANTS, 0.4 + 0j)
    shown[:, :, ring] = 0
    left = inclined(shown, TRUE, RADII, SLANTS, 0.4 + 0j)
    assert np.all(left[:, :, ring] == 0)
    others = np.arange(len(RADII)) != ring
    off = np.abs(left - whole)[:, :, others]
    assert np.sqrt(np.mean(off**2)) < 0.3 * np.sqrt(np.mean(np.abs(whole) ** 2))


@pytest.mark.parametrize("steep", [0.25, 0.4, -0.4])
def test_a_handle_tells_how_steep_it_is(steep: float) -> None:
    found = told(pictures(steep, SLANTS))
    assert found is not None
    assert found.real == pytest.approx(steep, abs=0.1)
    assert abs(found.imag) < 0.1


@pytest.mark.parametrize("steep", [0.3, -0.3])
def test_steady_spins_tell_it_where_pictures_are_little_alike(steep: float) -> None:
    found = told(spoilt(pictures(steep, SLANTS)))
    assert found is not None
    assert found.real == pytest.approx(steep, abs=0.1)
    assert told(spoilt(pictures(0.0, SLANTS))) is None


@pytest.mark.parametrize("spin", [-2.5, 3.0])
def test_spins_that_a_hit_changes_tell_it_too(spin: float) -> None:
    hit = TIMES[len(TIMES) // 2]
    after = np.maximum(TIMES - hit, 0)
    true = TRUE + (spin - 1.3) * after
    slants = SLANTS + after[:, None] * [0.05, 0.06]
    for steep in (0.0, 0.35):
        shown = turning(true, slants, steep)
        angles = align(shown, true, RADII, SD).angle
        found = rise_of_handle(TIMES, shown, angles, RADII, slants, SD)
        assert (0.0 if found is None else found.real) == pytest.approx(steep, abs=0.1)


@pytest.mark.parametrize("rate", [25, 60])
@pytest.mark.parametrize("steep", [0.3, -0.3])
def test_a_stone_that_comes_to_rest_tells_it_while_it_goes(steep: float, rate: int) -> None:
    times = np.arange(6 * rate) / rate
    way = np.minimum(times, 2.8) - np.minimum(times, 2.8) ** 2 / 5.6
    slants = np.column_stack([0.1 + 0 * times, 0.85 - 0.25 * way])
    true, sd = 0.4 + 1.3 * np.minimum(times, 2.8), np.full(len(times), 0.005)
    shown = spoilt(turning(true, slants, steep))
    angles = align(shown, true, RADII, sd).angle
    found = rise_of_handle(times, shown, angles, RADII, slants, sd)
    assert found is not None
    assert found.real == pytest.approx(steep, abs=0.05)


def test_level_handles_and_views_that_tell_nothing_have_none() -> None:
    steep = pictures(0.4, SLANTS)
    assert told(pictures(0.0, SLANTS)) is None
    assert told(steep, 0.9 * ASLANT * SLANTS / np.median(np.hypot(*SLANTS.T))) is None
    few = slice(0, 20)  # hardly turned
    hardly = rise_of_handle(TIMES[few], steep[few], TRUE[few], RADII, SLANTS[few], SD[few])
    assert hardly is None
    assert rise_of_handle(TIMES, 0 * steep, TRUE, RADII, SLANTS, SD) is None
    noise = np.random.default_rng(1).normal(0, 1, (2, *steep.shape))
    assert told(np.asarray(noise[0] + 1j * noise[1], np.complex64)) is None


@pytest.mark.parametrize("steep", [0.4, -0.4])
def test_spins_are_right_aslant_and_were_not(steep: float) -> None:
    shown = [*pictures(steep, SLANTS)]
    plain = handle_angles(TIMES, shown, RADII, SD)
    aslant = handle_angles(TIMES, shown, RADII, SD, SLANTS)
    assert abs(spin_off(plain.theta)) > 0.08
    assert abs(spin_off(aslant.theta)) < 0.3 * abs(spin_off(plain.theta))


def unlike(shown: Complex) -> float:
    """How far pictures turned back by their true angles are from their mean."""
    orders = np.arange(1, shown.shape[1] + 1)
    back = shown * np.exp(1j * orders * TRUE[:, None])[..., None, None]
    return float(np.abs(back - back.mean(0)).mean() / np.abs(back).mean())


@pytest.mark.parametrize("steep", [0.4, -0.3])
def test_on_a_plane_that_rises_with_it_a_handle_looks_the_same_from_all_sides(steep: float) -> None:
    shown = pictures(steep, SLANTS)
    level = inclined(shown, TRUE, RADII, SLANTS, complex(steep))
    wrong = inclined(shown, TRUE, RADII, SLANTS, complex(-steep))
    assert unlike(level) < 0.6 * unlike(shown) < 0.6 * unlike(wrong)


def test_a_level_plane_shows_what_was_unrolled() -> None:
    shown = pictures(0.3, SLANTS)
    same = inclined(shown, TRUE, RADII, SLANTS, 0j)
    assert np.abs(same - shown).max() < 0.02 * np.abs(shown).max()


def test_its_direction_is_told_as_angles_count() -> None:
    shown = pictures(0.3, SLANTS)
    angles = align(shown, TRUE - 1.0, RADII, SD).angle
    found = rise_of_handle(TIMES, shown, angles, RADII, SLANTS, SD)
    assert found == pytest.approx(0.3 * np.exp(1j), abs=0.05)


def test_a_handle_that_hardly_rises_is_left_as_it_is() -> None:
    assert told(pictures(0.1, SLANTS)) is None


def test_spins_that_are_unsteady_by_themselves_do_not_tell_a_rise() -> None:
    true = TRUE + 0.2 * np.sin(4 * TIMES + 0.5)
    shown = spoilt(turning(true, SLANTS, 0.0))
    angles = align(shown, true, RADII, SD).angle
    assert rise_of_handle(TIMES, shown, angles, RADII, SLANTS, SD) is None
