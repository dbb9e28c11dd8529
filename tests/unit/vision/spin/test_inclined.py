from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.handles import RADII
from curlshot.tests.helpers.vision.inclined import SD, SLANTS, spoilt, told
from curlshot.tests.helpers.vision.steep_handles import TIMES, TRUE, pictures, turning
from curlshot.vision.spin.align import Complex, align
from curlshot.vision.spin.inclined import inclined, rise_of_handle


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
