from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.vision.spin.test_handle import RADII
from tests.vision.spin.test_pitch import TIMES, TRUE, pictures, spin_off
from vision.film.shelf import Kept
from vision.spin.align import Complex, align
from vision.spin.angles import angles_in_parts
from vision.spin.common_make import common_steepness
from vision.spin.handle import HandleAngles, handle_angles
from vision.spin.inclined import ASLANT, inclined, steepness, uphill_end

Array = NDArray[np.float64]

SLANTS = np.column_stack([0.1 + 0 * TIMES, 0.85 - 0.08 * TIMES])
SD = np.full(len(TIMES), 0.005)


def unlike(shown: Complex) -> float:
    """How far pictures turned back by their true angles are from their mean."""
    orders = np.arange(1, shown.shape[1] + 1)
    back = shown * np.exp(1j * orders * TRUE[:, None])[..., None, None]
    return float(np.abs(back - back.mean(0)).mean() / np.abs(back).mean())


def told(shown: Complex, slants: Array = SLANTS) -> float | None:
    return steepness(shown, align(shown, TRUE, RADII, SD).angle, RADII, slants, SD)


@pytest.mark.parametrize("steep", [0.4, -0.3])
def test_on_a_plane_that_rises_with_it_a_handle_looks_the_same_from_all_sides(steep: float) -> None:
    shown = pictures(steep, SLANTS)
    level = inclined(shown, TRUE, RADII, SLANTS, complex(steep))
    wrong = inclined(shown, TRUE, RADII, SLANTS, complex(-steep))
    assert unlike(level) < 0.6 * unlike(shown) < 0.6 * unlike(wrong)


def test_a_level_plane_shows_what_was_unrolled() -> None:
    shown = pictures(0.3, SLANTS)
    shown[3, :, 2] = 0  # a ring that is not seen
    same = inclined(shown, TRUE, RADII, SLANTS, 0j)
    assert np.all(same[3, :, 2] == 0)
    assert np.abs(same - shown).max() < 0.02 * np.abs(shown).max()


@pytest.mark.parametrize("steep", [0.25, 0.4, -0.4])
def test_a_handle_tells_how_steep_it_is(steep: float) -> None:
    found = told(pictures(steep, SLANTS))
    assert found is not None
    assert abs(found) == pytest.approx(abs(steep), abs=0.1)


def test_level_handles_and_views_that_tell_nothing_have_none() -> None:
    steep = pictures(0.4, SLANTS)
    assert told(pictures(0.0, SLANTS)) is None
    assert told(steep, 0.9 * ASLANT * SLANTS / np.median(np.hypot(*SLANTS.T))) is None
    few = slice(0, 20)  # hardly turned
    assert steepness(steep[few], TRUE[few], RADII, SLANTS[few], SD[few]) is None
    noise = np.random.default_rng(1).normal(0, 1, (2, *steep.shape))
    assert told(np.asarray(noise[0] + 1j * noise[1], np.complex64)) is None


@pytest.mark.parametrize("steep", [0.4, -0.4])
def test_spins_are_right_aslant_and_were_not(steep: float) -> None:
    shown = [*pictures(steep, SLANTS)]
    plain = handle_angles(TIMES, shown, RADII, SD)
    aslant = handle_angles(TIMES, shown, RADII, SD, SLANTS)
    assert aslant.steep is not None and plain.steep is None
    assert abs(spin_off(plain.theta)) > 0.08
    assert abs(spin_off(aslant.theta)) < 0.3 * abs(spin_off(plain.theta))


@pytest.mark.parametrize(("steep", "clear"), [(-0.4, True), (0.4, False)])
def test_a_stone_that_hardly_turned_takes_the_steepness_of_the_others(
    steep: float, clear: bool
) -> None:
    """If its pictures say clearly at which end it is higher."""
    few = slice(0, 24)
    shown = [*map(Kept, pictures(steep, SLANTS)[few])]

    def spin(given: float | None) -> tuple[float, float | None]:
        angles = angles_in_parts(TIMES[few], shown, RADII, SD[few], slants=SLANTS[few], steep=given)
        return float(np.polyfit(TIMES[few], angles.theta - TRUE[few], 1)[0]), angles.steep

    (alone, itself), (helped, still) = spin(None), spin(0.4)
    assert itself is None and still is None
    assert abs(alone) > 0.08
    assert (abs(helped) < 0.4 * abs(alone)) if clear else helped == alone


def test_which_end_is_higher_is_told_by_the_pictures() -> None:
    for steep in (0.4, -0.4):
        shown = pictures(steep, SLANTS)
        itself = told(shown)
        assert itself is not None
        end = uphill_end(shown, TRUE, RADII, SLANTS, SD, 0.4)
        assert np.sign(end) == np.sign(itself) and abs(end) == 0.4
    assert uphill_end(pictures(0.0, SLANTS), TRUE, RADII, SLANTS, SD, 0.4) == 0.0
    blank = np.zeros_like(shown)
    assert uphill_end(blank, TRUE, RADII, SLANTS, SD, 0.4) == 0.0


def test_stones_of_one_clip_are_as_steep_to_either_end() -> None:
    def of(steep: float | None) -> HandleAngles:
        return HandleAngles(TRUE, SD, np.zeros((len(TRUE), 2)), np.ones(2), frozenset({0}), steep)

    assert common_steepness([of(None), of(None)]) is None
    assert common_steepness([of(0.3), of(None), of(-0.5), of(0.35)]) == pytest.approx(0.35)
