from __future__ import annotations

import numpy as np
import pytest

from curlshot.tests.helpers.vision.handles import RADII
from curlshot.tests.helpers.vision.steep_handles import (
    SLANTS,
    TIMES,
    TRUE,
    Array,
    pictures,
    spin_off,
)
from curlshot.vision.spin.align import align
from curlshot.vision.spin.angles import angles_in_parts
from curlshot.vision.spin.handle import handle_angles
from curlshot.vision.spin.pitch import levelled
from curlshot.vision.video.disk_cache import Cached


def size(rise: Array) -> float:
    """Root mean square of what angles are off by together, over the pictures, rad."""
    return float(np.sqrt(np.mean(np.sum(rise**2, axis=1))))


@pytest.mark.parametrize("steep", [0.35, -0.35])
def test_a_handle_that_rises_is_not_taken_for_a_turn(steep: float) -> None:
    shown = pictures(steep)
    sd = np.full(len(TIMES), 0.002)
    fit = align(shown, TRUE, RADII, sd)
    angles, rise = levelled(shown, fit.angle, RADII, SLANTS)
    before, after = spin_off(fit.angle), spin_off(angles)
    assert abs(before) > 0.03
    assert abs(after) < 0.4 * abs(before)
    # What is left is a rise that was not taken out, by less than two of its errors.
    error = angles - TRUE - np.median(angles - TRUE)
    left = np.linalg.lstsq(rise, error, rcond=None)[0]
    assert np.abs(left).max() < 2
    assert np.abs(error - rise @ left).max() < 0.02
    assert np.mean(np.abs(error) < 2 * np.hypot(size(rise), 0.01)) > 0.9


def test_a_flat_handle_is_left_as_it_is_seen() -> None:
    shown = pictures(0.0)
    sd = np.full(len(TIMES), 0.002)
    fit = align(shown, TRUE, RADII, sd)
    angles, rise = levelled(shown, fit.angle, RADII, SLANTS)
    assert np.abs(angles - fit.angle - np.median(angles - fit.angle)).max() < 0.02
    assert 0 < size(rise) < 0.06


def test_far_aslant_it_is_believed_less() -> None:
    shown = pictures(0.35)
    whole, less = (levelled(shown, TRUE, RADII, scale * SLANTS)[0] - TRUE for scale in (1.0, 10.0))
    # Pictures that change as little in a view ten times as slanting: steep by a tenth.
    assert np.ptp(less) < 0.3 * np.ptp(whole)


def test_from_above_nothing_is_steep() -> None:
    shown = pictures(0.35, 0 * SLANTS)
    angles, rise = levelled(shown, TRUE, RADII, 0 * SLANTS)
    assert angles == pytest.approx(TRUE, abs=1e-9)
    assert rise == pytest.approx(0.0, abs=1e-9)


def test_many_pictures_are_levelled_alike_part_by_part(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = pictures(0.35)
    whole, _ = levelled(shown, TRUE, RADII, SLANTS)
    monkeypatch.setattr("curlshot.vision.spin.shade.TOGETHER", 30)
    parts, _ = levelled(shown, TRUE, RADII, SLANTS)
    assert parts == pytest.approx(whole, abs=2e-3)


def test_what_is_left_is_by_the_axes_of_the_cap_in_each_part_of_a_way() -> None:
    shown = pictures(0.35)
    for part in (slice(40), slice(30, None)):
        ahead, aside = levelled(shown[part], TRUE[part], RADII, SLANTS[part])[1].std(0)
        assert ahead > 0.006 and aside < 0.1 * ahead


def test_dim_pictures_say_as_much_of_the_rise_as_bright_ones() -> None:
    shown = pictures(0.35)
    dim = np.where(np.arange(len(TIMES)) % 2, 1.0, 0.4).astype(np.float32)
    angles, whole = (
        levelled(p, TRUE, RADII, SLANTS)[0] for p in (shown, shown * dim[:, None, None, None])
    )
    assert angles == pytest.approx(whole, abs=0.003)


def test_angles_of_a_stone_are_levelled() -> None:
    shown = [*pictures(0.35)]
    sd = np.full(len(TIMES), 0.0005)
    plain = handle_angles(TIMES, shown, RADII, sd)
    aslant = handle_angles(TIMES, shown, RADII, sd, SLANTS)
    flat = handle_angles(TIMES, shown, RADII, sd, 0 * SLANTS)
    assert flat.theta == pytest.approx(plain.theta, abs=1e-9)
    assert abs(spin_off(aslant.theta)) < 0.5 * abs(spin_off(plain.theta))
    assert np.hypot(aslant.sd, size(aslant.rise)).min() > 1.2 * flat.sd.max()
    assert not flat.rise.any()


@pytest.mark.parametrize("most", [500, 40])
def test_angles_that_are_told_part_by_part_are_levelled_too(most: int) -> None:
    shown = [*map(Cached, pictures(0.35))]
    sd = np.full(len(TIMES), 0.0005)
    plain = angles_in_parts(TIMES, shown, RADII, sd, most)
    aslant = angles_in_parts(TIMES, shown, RADII, sd, most, SLANTS)
    assert np.ptp(aslant.theta - plain.theta) > 0.03


def test_no_picture_counts_more_for_being_turned_as_most_are() -> None:
    # What a handle's rise turns pictures by is alike for long: it is no noise of each of them.
    sd = np.full(len(TIMES), 0.0005)
    far = 3.0 * SLANTS
    told = handle_angles(TIMES, [*pictures(0.0, far)], RADII, sd, far)
    assert np.hypot(told.sd, size(told.rise)).min() > 0.04
    assert told.sd.max() < 1.5 * told.sd.min()
