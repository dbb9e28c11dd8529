from __future__ import annotations

import numpy as np
import pytest

from curlshot.vision.spin.align import ORDERS, TOGETHER
from curlshot.vision.spin.shade import parts, unturned, upright_mean

SHAPE = len(ORDERS), 4, 3


def any_picture(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (rng.normal(size=SHAPE) + 1j * rng.normal(size=SHAPE)).astype(np.complex64)


def turning(cap: np.ndarray, light: np.ndarray, angles: np.ndarray) -> np.ndarray:
    phase = np.exp(-1j * ORDERS * angles[:, None])[..., None, None]
    return np.asarray(light + phase * cap, np.complex64)


def test_of_light_on_a_cap_that_has_turned_round_half_is_told() -> None:
    cap, light = any_picture(1), any_picture(2)
    angles = np.arange(60) * (2 * np.pi / 60)
    shown = np.ones((60, 1, 4, 1), bool)
    told = unturned(turning(cap, light, angles), angles, shown)
    assert told == pytest.approx(0.5 * light, abs=1e-4)


def test_nothing_is_told_of_light_on_a_cap_that_rests() -> None:
    cap, light = any_picture(1), any_picture(2)
    angles = np.full(60, 0.7)
    told = unturned(turning(cap, light, angles), angles, np.ones((60, 1, 4, 1), bool))
    assert np.abs(told).max() < 1e-3


def test_a_mean_is_over_the_pictures_that_show_a_ring_and_tell_an_angle() -> None:
    cap, rng = any_picture(1), np.random.default_rng(3)
    count = 2 * TOGETHER + 5
    angles = rng.uniform(-3, 3, count)
    shown = rng.random((count, 1, 4, 1)) < 0.6
    pictures = turning(cap, 0 * cap, angles) * shown
    angles[::7] = np.nan
    assert upright_mean(pictures, angles, shown) == pytest.approx(cap, abs=1e-4)


def test_lists_are_cut_into_parts_that_are_all_of_them() -> None:
    cut = parts(np.arange(2 * TOGETHER + 5))
    assert [len(part) for part in cut] == [TOGETHER, TOGETHER, 5]
    assert np.concatenate(cut).tolist() == [*range(2 * TOGETHER + 5)]
