from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.detection.contrast import (
    LIGHT,
    MOST_LIGHT,
    alike,
    by_hue,
    by_lightness,
    mean_colours,
    own_worth,
    worth_of,
)

GRANITE = np.array([[118.0, 127.0, 126.0]])
RED, YELLOW, TEAL = [97.0, 183.0, 170.0], [208.0, 118.0, 209.0], [112.0, 92.0, 126.0]


@pytest.mark.parametrize("cap", [RED, YELLOW, TEAL])
def test_a_cap_is_one_more_than_its_granite(cap: list[float]) -> None:
    caps = np.array([cap])
    assert ((caps - GRANITE) * by_hue(caps, GRANITE)).sum() == pytest.approx(1.0)
    assert (caps - GRANITE)[0, 0] * by_lightness(caps, GRANITE)[0] == pytest.approx(1.0)


def test_lightness_says_little_beside_a_vivid_hue_and_more_beside_a_faint_one() -> None:
    caps = np.array([RED, YELLOW, TEAL])
    weight, apart = by_hue(caps, GRANITE), caps - GRANITE
    say = weight * apart
    assert say[1, 0] == pytest.approx(MOST_LIGHT * say[1, 1:].sum())
    assert (say[:, 0] <= MOST_LIGHT * say[:, 1:].sum(1) + 1e-12)[:2].all()
    assert weight[2, 0] / apart[2, 0] == pytest.approx(LIGHT * weight[2, 1] / apart[2, 1])


def test_without_any_hue_lightness_tells_a_cap() -> None:
    dark = GRANITE - np.array([[70.0, 0.0, 0.0]])
    np.testing.assert_allclose(by_hue(dark, GRANITE), [[-1 / 70, 0, 0]])


def test_what_is_as_light_as_its_granite_has_no_edge_by_lightness() -> None:
    alike = GRANITE + np.array([[0.4, 50.0, 0.0]])
    assert abs(by_lightness(alike, GRANITE)[0]) == 1.0


def test_means_are_of_what_is_chosen() -> None:
    values = np.arange(24, dtype=np.float32).reshape(1, 2, 4, 3)
    use = np.zeros((1, 2, 4), np.float32)
    use[0, 0, 1] = use[0, 1, 2] = 1
    np.testing.assert_allclose(mean_colours(values, use)[0], [10.5, 11.5, 12.5])
    np.testing.assert_allclose(mean_colours(values, 0 * use)[0], 0)


@pytest.mark.parametrize("apart", [16, 30])
def test_by_their_own_colours_places_tell_cap_and_granite_and_what_is_neither(apart: int) -> None:
    """A dark cap in grey granite, as a picture without colours has it, with a mark on each."""
    lab = np.full((1, 12, 10, 3), (62, 128, 128), np.uint8)
    lab[:, :, 6:] = (62 + apart, 128, 128)
    lab[0, 0, [2, 8]] = (240, 128, 128)
    worth = own_worth(lab, slice(0, 5), slice(6, 10))[0]
    assert (worth[1:, :6] > 0.9).all() and (worth[1:, 6:] < -0.9).all()
    assert worth[0, [2, 8]] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("to_cap", "to_granite", "expected"),
    [(0.0, 5.0, 1.0), (5.0, 1.0, -1.0), (1.0, 1.75, 0.5), (4.5, 9.0, 0.0), (3.75, 9.0, 0.5)],
)
def test_what_is_nearer_counts_by_how_much_and_what_is_far_from_both_nothing(
    to_cap: float, to_granite: float, expected: float
) -> None:
    cap, granite = (np.array([value], np.float32) for value in (to_cap, to_granite))
    assert worth_of(cap, granite)[0] == pytest.approx(expected)


def test_what_is_one_colour_shows_no_cap() -> None:
    lab = np.full((1, 12, 10, 3), (62, 128, 128), np.uint8)
    lab[:, :, 6:, 0] += 6
    assert not own_worth(lab, slice(0, 5), slice(6, 10)).any()


def test_a_ring_of_other_granite_than_is_known_is_none() -> None:
    lab = np.full((1, 12, 10, 3), (62, 128, 128), np.uint8)
    lab[:, :, 6:] = (92, 128, 128)
    told = [
        own_worth(lab, slice(0, 5), slice(6, 10), np.array([light, 128.0, 128.0])).any()
        for light in (100.0, 160.0)
    ]
    assert told == [True, False]


def test_granite_is_as_light_and_as_grey_as_that_of_other_stones_about() -> None:
    known = GRANITE[0]
    others = known + np.array([[20.0, 0, 0], [0, 8, -8], [30, 0, 0], [0, 15, 0]])
    assert alike(others, known).tolist() == [True, True, False, False]
