from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.tests.helpers.vision.handles import RADII, RAYS, SURE, patch, spectrum
from curlshot.vision.spin.handle import cap_spectrum
from curlshot.vision.spin.handle import handle_angles as angles_about


def handle_angles(
    times: NDArray[np.float64],
    spectra: Sequence[NDArray[np.complex64] | None],
    radii: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    told = angles_about(times, spectra, radii, np.full(len(times), SURE))
    return told.theta, told.sd


def test_many_turns_are_counted_without_drift() -> None:
    rng = np.random.default_rng(1)
    times = np.arange(400) / 25
    true = 0.4 + 2.2 * times
    theta, sd = handle_angles(times, [spectrum(a, rng) for a in true], RADII)
    error = theta - true
    assert np.abs(error).max() < 0.03
    assert abs(np.polyfit(times, error, 1)[0]) < 2e-4
    # Noise is all there is here; what real pictures add is allowed for.
    assert 0.1 < np.std(error) / np.median(sd) < 2.0


def test_two_seconds_out_of_sight_are_bridged() -> None:
    times = np.arange(150) / 25
    true = 0.9 * times
    seen = [None if 50 <= i < 100 else spectrum(a) for i, a in enumerate(true)]
    theta, _ = handle_angles(times, seen, RADII)
    assert np.isnan(theta[50:100]).all()
    assert theta[149] == pytest.approx(true[149], abs=0.02)


def test_a_cap_that_looks_alike_all_round_has_no_angle() -> None:
    rng = np.random.default_rng(2)
    blank = np.full((RAYS, len(RADII), 3), 120.0)
    noisy = [
        cap_spectrum((blank + rng.normal(0, 6, blank.shape)).astype(np.uint8), RADII)
        for _ in range(60)
    ]
    theta, sd = handle_angles(np.arange(60) / 25, noisy, RADII)
    assert np.isnan(theta).all()
    assert np.isnan(sd).all()


def test_a_stone_never_seen_well_has_no_angle() -> None:
    theta, _ = handle_angles(np.arange(3) / 25, [None, None, None], RADII)
    assert np.isnan(theta).all()


@pytest.mark.parametrize("first", [True, False])
def test_the_height_is_believed_at_which_the_pictures_agree(first: bool) -> None:
    rng = np.random.default_rng(5)
    times = np.arange(50) / 25
    true = 0.3 + 1.2 * times
    right = [spectrum(a, rng) for a in true]
    # At another height part of what is seen turns, part stays.
    wrong = [(spectrum(a, rng) + spectrum(0.0, rng)) / 2 for a in true]
    seen = [
        np.concatenate([r, w] if first else [w, r], 1) for r, w in zip(right, wrong, strict=True)
    ]
    theta, sd = handle_angles(times, seen, RADII)
    assert np.abs(theta - true).max() < 5 * np.nanmax(sd)


def test_a_handle_seen_beside_its_place_is_not_taken_for_turned() -> None:
    # A camera that moves on sees the handle, which stands above the cap, shifted by millimetres.
    rng = np.random.default_rng(3)
    times = np.arange(120) / 25
    true = 0.4 * times
    aside = np.linspace(-0.004, 0.004, len(times))
    shifts = np.stack([aside, -0.5 * aside], 1).tolist()
    seen = [
        cap_spectrum(patch(a, rng, (x, y)), RADII) for a, (x, y) in zip(true, shifts, strict=True)
    ]
    theta, sd = handle_angles(times, seen, RADII)
    slope = np.polyfit(times, theta - true, 1)[0]
    assert abs(slope) < 0.008
    assert np.std(theta - true) < 1.5 * np.median(sd)


def test_light_that_does_not_turn_with_the_stone_is_taken_out() -> None:
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    light = 60 * np.exp(-(((RADII - 0.06) / 0.02) ** 2) + 4 * (np.cos(angle - 1.0) - 1))
    times = np.arange(100) / 25
    true = 1.3 * times
    lit = [np.clip(patch(a) + light[..., None], 0, 255).astype(np.uint8) for a in true]
    theta, _ = handle_angles(times, [cap_spectrum(a, RADII) for a in lit], RADII)
    assert np.std(theta - true) < 0.004


@pytest.mark.parametrize(("shade", "shift"), [(0.6, 0.0), (0.0, 0.008), (0.6, 0.008)])
def test_a_handle_shaded_or_seen_aslant_is_not_held_back(shade: float, shift: float) -> None:
    """It is lighter where it points to the lamp, and moves over the cap as the view steepens."""
    share = np.arange(60) / 59
    cap = np.array([80.0, 170.0, 150.0])
    off = []
    for start in np.arange(6) * np.pi / 3:
        true = start + 1.6 * share
        shown = [
            cap + (patch(a, shift=(0, shift * (1 - q))) - cap) * (1 + shade * np.cos(a - 1.0))
            for a, q in zip(true, share, strict=True)
        ]
        spectra = [cap_spectrum(np.clip(p, 0, 255).astype(np.uint8), RADII) for p in shown]
        theta, _ = handle_angles(2.4 * share, spectra, RADII)
        off.append(np.polyfit(true, theta, 1)[0] - 1)
    assert np.sqrt(np.mean(np.square(off))) < (0.004 if shift == 0 else 0.012)


def test_a_stone_that_comes_into_the_picture_is_told_by_what_is_seen_of_it() -> None:
    times = np.arange(60) / 25
    true = 0.8 * times
    pictures = [spectrum(a) for a in true]
    for index in range(10):  # only its innermost rings are wholly in the picture
        pictures[index][:, 3:] = 0
    theta, sd = handle_angles(times, pictures, RADII)
    assert np.isfinite(theta[10:]).all()
    assert np.nanmax(np.abs(theta - true - np.median(theta[10:] - true[10:]))) < 0.05
    assert np.nanmedian(sd[:10]) > np.median(sd[10:])


def test_caps_that_show_nothing_tell_no_angle() -> None:
    blank = np.zeros_like(spectrum(0.0))
    theta, sd = handle_angles(np.arange(30) / 25, [blank] * 30, RADII)
    assert np.isnan(theta).all()
    assert np.isnan(sd).all()


def test_a_cap_that_a_slanting_view_hides_at_first_is_told_once_it_is_seen() -> None:
    rng = np.random.default_rng(6)
    times = np.arange(80) / 25
    true = 1.1 * times
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    hidden = np.where((RADII * np.sin(9 * angle) > 0)[..., None], 60, 150)
    before = cap_spectrum(np.repeat(hidden, 3, -1).astype(np.uint8), RADII)
    pictures = [before if i < 15 else spectrum(a, rng) for i, a in enumerate(true)]
    theta, _ = handle_angles(times, pictures, RADII)
    assert np.isnan(theta[:15]).all()
    assert np.abs(theta - true - np.nanmedian(theta - true))[15:].max() < 0.03


def test_one_picture_and_one_of_something_else_tell_no_angle() -> None:
    noise = np.random.default_rng(3).integers(0, 255, patch(0.0).shape, dtype=np.uint8)
    pictures = [spectrum(0.0), cap_spectrum(noise, RADII)]
    theta, sd = handle_angles(np.array([0.0, 0.04]), pictures, RADII)
    assert np.isnan(theta).all() and np.isnan(sd).all()


def test_something_before_the_cap_leaves_the_angle_open() -> None:
    rng = np.random.default_rng(7)
    times = np.arange(80) / 25
    true = 0.7 * times
    pictures = [spectrum(a, rng) for a in true]
    for index in range(60, 70):  # a dark bar over a part of it
        covered = patch(true[index], rng)
        covered[5:12] = 20
        pictures[index] = cap_spectrum(covered, RADII)
    theta, sd = handle_angles(times, pictures, RADII)
    told = np.isfinite(theta)
    off = np.abs(theta - true - np.nanmedian(theta - true))
    assert told[:60].all()
    assert (off[told] < 2 * sd[told]).all()
    assert (~told[60:70] | (sd[60:70] > 2 * np.nanmedian(sd))).all()


def test_what_goes_over_a_cap_step_by_step_does_not_lead_its_angle_away() -> None:
    rng = np.random.default_rng(9)
    times = np.arange(60) / 25
    pictures = [spectrum(0.0, rng) for _ in times]
    unlike = rng.normal(0, 27, patch(0.0).shape)
    for index in range(20, 45):
        over = np.clip(patch(0.12 * (index - 19), rng) + unlike, 0, 255)
        pictures[index] = cap_spectrum(over.astype(np.uint8), RADII)
    theta, _ = handle_angles(times, pictures, RADII)
    assert np.abs(theta[[*range(20), *range(45, 60)]]).max() < 0.03


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_broom_that_goes_over_a_cap_at_rest_does_not_turn_it(seed: int) -> None:
    """A dark bar across it swings by 75° in half a second; pictures before that are missing."""
    rng = np.random.default_rng(seed)
    times = np.concatenate([np.arange(16), np.arange(16, 45) + 7.5]) / 25
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    pictures = []
    for index in range(len(times)):
        seen, swing = patch(0.0, rng), 3.0 * (index - 16) / 25
        over = np.abs(RADII * np.sin(angle - swing) - 0.03) < 0.02
        seen[over & (16 <= index < 28)] = 60, 128, 128
        pictures.append(cap_spectrum(seen, RADII))
    theta, _ = handle_angles(times, pictures, RADII)
    assert np.abs(theta[[*range(16), *range(28, 45)]]).max() < 0.03


def test_a_faint_handle_alike_at_both_ends_does_not_jump_by_half_a_turn() -> None:
    rng = np.random.default_rng(10)
    times = np.arange(100) / 25
    true = 1.3 * times
    angle = np.arange(RAYS) * (2 * np.pi / RAYS)
    faint = cv2.GaussianBlur(rng.normal(0, 1, (RAYS, len(RADII))), (0, 0), 1.5)
    pictures = []
    for time, turn in zip(times, true, strict=True):
        bar = 60 * np.cos(2 * (angle - turn))[:, None] * (RADII < 0.07) + 0 * RADII
        grain = cv2.GaussianBlur(rng.normal(0, 1, bar.shape), (0, 0), 1.5)
        value = 120 + bar + 12 * grain / grain.std()
        value += (50 if 0.8 < time < 2.8 else 0) * faint / faint.std()
        pictures.append(cap_spectrum(np.repeat(value[..., None], 3, -1).astype(np.uint8), RADII))
    theta, _ = handle_angles(times, pictures, RADII)
    told = np.isfinite(theta)
    assert told.mean() > 0.5
    assert np.abs(theta - true - np.median((theta - true)[told]))[told].max() < 0.5


def test_what_is_unrolled_about_an_unsure_centre_is_less_sure() -> None:
    rng = np.random.default_rng(8)
    times = np.arange(60) / 25
    pictures = [spectrum(a, rng) for a in 0.9 * times]
    unsure = np.where(times < 0.2, 0.004, SURE)
    _, before = handle_angles(times, pictures, RADII)
    sd = angles_about(times, pictures, RADII, unsure).sd
    assert (sd[:5] > before[:5]).all()
    assert sd[5:] == pytest.approx(before[5:], rel=0.02)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_shade_that_stays_on_the_cap_is_not_believed_before_a_grip_that_turns(seed: int) -> None:
    rng = np.random.default_rng(seed)
    times = np.arange(100) / 25
    true = 0.9 * times
    shade = patch(0.3).astype(float)
    pictures = []
    for turn in true:
        grain = [cv2.GaussianBlur(rng.normal(0, 1, shade.shape[:2]), (0, 0), 2.5) for _ in "12"]
        grip, cap = (each[..., None] / each.std() for each in grain)
        both = np.concatenate([patch(turn) + 7.5 * grip, shade + 7.0 * cap], axis=1)
        pictures.append(cap_spectrum(np.clip(both, 0, 255).astype(np.uint8), RADII))
    theta, _ = handle_angles(times, pictures, RADII)
    assert abs(np.polyfit(times, theta - true, 1)[0]) < 0.02


def test_a_cap_that_is_often_unlike_itself_is_less_sure_throughout() -> None:
    times = np.arange(100) / 25

    def told(unlike: int) -> float:
        rng = np.random.default_rng(5)
        pictures = [spectrum(0.9 * t, rng) for t in times]
        for index in rng.permutation(100)[:unlike]:
            pictures[index] = cap_spectrum(rng.integers(0, 255, (RAYS, len(RADII), 3)), RADII)
        theta, sd = handle_angles(times, pictures, RADII)
        assert np.nanstd(theta - 0.9 * times) < 0.03
        return float(np.nanmedian(sd))

    usual = told(0)
    assert told(10) < 1.2 * usual  # something passed by
    assert told(40) > 1.6 * usual  # nobody knows what the others show


def flickering(
    spin: float, much: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Angles, their errors and what they state, of a cap that flickers, its handle plain."""
    rng = np.random.default_rng(5)
    times = np.arange(100) / 25
    pictures = []
    for t in times:
        grain = cv2.GaussianBlur(rng.normal(0, 1, (RAYS, len(RADII))), (0, 0), 2.5)
        seen = patch(spin * t) + much * (grain / grain.std())[..., None]
        pictures.append(cap_spectrum(np.clip(seen, 0, 255).astype(np.uint8), RADII))
    theta, sd = handle_angles(times, pictures, RADII)
    return theta, theta - spin * times, sd


def test_a_cap_that_changes_otherwise_than_it_turns_is_less_sure_throughout() -> None:
    (_, off, slow), (_, far_off, fast) = flickering(0.2, 12.0), flickering(2.0, 12.0)
    assert max(np.nanstd(off), np.nanstd(far_off)) < 0.1
    # What hardly turns may be light, and nothing else is known to turn.
    assert np.nanmedian(slow) > 1.8 * np.nanmedian(fast)


def test_angles_that_are_known_to_half_a_radian_at_best_are_not_told() -> None:
    assert np.isfinite(flickering(0.2, 12.0)[0]).all()  # stated to 0.26 rad
    theta, _, sd = flickering(0.2, 18.0)  # 0.67
    assert np.isnan(theta).all() and np.isnan(sd).all()
    assert np.isfinite(flickering(2.0, 18.0)[0]).any()  # 0.26 once more


@pytest.mark.parametrize("bright", [1.0, 0.2])
def test_brooms_over_a_handle_in_the_caps_own_colour_are_not_followed(bright: float) -> None:
    """One goes to and fro over a side of the cap in seven pictures of twelve, as people sweep."""
    rng = np.random.default_rng(3)
    times = np.arange(75) / 25
    free = np.arange(75) % 12 < 5
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    plain = np.array([80.0, 170, 150])
    pictures = []
    for t, clear in zip(times, free, strict=True):
        seen = plain + bright * (patch(1.2 * t) - plain) + rng.normal(0, 1, (RAYS, len(RADII), 3))
        over = RADII * np.cos(angle - 1.3 - 0.9 * np.sin(9 * t)) > 0.03
        seen[over & (not clear)] = 30, 128, 128
        pictures.append(cap_spectrum(np.clip(seen, 0, 255).astype(np.uint8), RADII))
    theta, sd = handle_angles(times, pictures, RADII)
    off = theta - 1.2 * times
    assert np.abs(off[free] - off[free][0]).max() < 0.03
    told = np.isfinite(theta)
    assert (np.abs(off - off[free][0])[told] < 2 * sd[told]).mean() > 0.9


def test_where_grip_and_cap_tell_different_angles_errors_say_so() -> None:
    times = np.arange(100) / 25

    def told(other: float) -> NDArray[np.float64]:
        rng = np.random.default_rng(4)
        pictures = [
            np.concatenate([spectrum(0.9 * t, rng), spectrum(other * t, rng)], axis=1)
            for t in times
        ]
        return handle_angles(times, pictures, RADII)[1]

    # 0.03 rad/s apart, and so up to 0.06 rad about the middle.
    assert told(0.93)[[0, -1]].min() > 0.05
    assert told(0.93)[50] < told(0.90)[50] + 0.01


def faint_within_a_rim(
    spin: float, narrow: float, bright: float, rim: float, lasting: float
) -> tuple[NDArray[np.float64], list[NDArray[np.complex64]]]:
    """Pictures of a turning cap whose rim shows now this and now that of what is beside it."""
    rng, times = np.random.default_rng(4), np.arange(90) / 25
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    beside = cv2.GaussianBlur(rng.normal(0, 1, (len(times), RAYS)), (0, 0), 4.0)
    stays = cv2.GaussianBlur(rng.normal(0, 1, (1, RAYS)), (0, 0), 4.0)
    rims = rim * (beside / beside.std() + lasting * stays / stays.std())
    pictures: list[NDArray[np.complex64]] = []
    for time, edge in zip(times, rims, strict=True):
        dot = np.exp(-narrow * (1 - np.cos(angle - spin * time))) * (RADII > 0.03) * (RADII < 0.06)
        grain = cv2.GaussianBlur(rng.normal(0, 1, dot.shape), (0, 0), 1.5)
        value = 120 + bright * dot + edge[:, None] * (RADII > 0.07) + 3 * grain / grain.std()
        pictures.append(cap_spectrum(np.repeat(value[..., None], 3, -1).astype(np.uint8), RADII))
    return times, pictures


@pytest.mark.parametrize(
    ("spin", "narrow", "bright", "rim"), [(2.0, 6, 50, 25), (2.5, 10, 25, 25), (2.0, 10, 50, 40)]
)
def test_a_faint_handle_is_told_beside_a_rim_that_does_not_turn(
    spin: float, narrow: float, bright: float, rim: float
) -> None:
    times, pictures = faint_within_a_rim(spin, narrow, bright, rim, 0.3)
    theta, _ = handle_angles(times, pictures, RADII)
    told = np.isfinite(theta)
    assert told.mean() > 0.9
    assert np.polyfit(times[told], theta[told], 1)[0] == pytest.approx(spin, abs=0.05)


def test_what_hardly_any_pictures_share_and_does_not_turn_tells_no_angle() -> None:
    times, pictures = faint_within_a_rim(1.5, 4, 22, 8, 0.45)
    assert np.isnan(handle_angles(times, pictures, RADII)[0]).all()
