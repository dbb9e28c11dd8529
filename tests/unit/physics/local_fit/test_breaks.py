from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.filter.stretch import PLACE_MEMORY
from curlshot.physics.local_fit.breaks import breaks
from curlshot.tests.helpers.physics.breaks import T, seen
from curlshot.tests.helpers.physics.watch import lasting


def test_an_even_motion_has_no_breaks() -> None:
    for seed in range(10):
        sd = np.full((len(T), 2), 0.005)
        assert breaks(T, seen(1.5 * T - 0.05 * T**2, 0.005, seed), sd) == []
        assert breaks(T, seen(0 * T, 0.005, seed), sd) == []


def test_errors_that_last_for_a_while_are_no_breaks_and_a_push_among_them_is_one() -> None:
    stated = np.full((len(T), 2), 0.0012)
    for seed in range(15):
        rng = np.random.default_rng(seed)
        xy = seen(1.5 * T - 0.05 * T**2, 0.0007, seed)
        for axis in range(2):
            xy[:, axis] += lasting(rng, T, 0.002, PLACE_MEMORY)
        assert breaks(T, xy, stated) == []
        xy[:, 1] -= np.maximum(0, 0.15 * (T - 2))
        assert breaks(T, xy, stated) == pytest.approx([2], abs=0.2)


def test_rows_minutes_apart_are_looked_at_without_complaint() -> None:
    sd = np.full((len(T), 2), 0.001)
    for pace in (100.0, 3000.0):  # milliseconds taken for seconds, and worse
        breaks(pace * T, seen(1.5 * T - 0.05 * T**2, 0.001), sd)


def test_single_outliers_are_no_breaks() -> None:
    xy = seen(1.2 * T, 0.004)
    xy[[20, 55, 90]] += 0.3
    assert breaks(T, xy, np.full((len(T), 2), 0.004)) == []


def test_a_stone_at_rest_under_a_camera_that_wanders_has_no_breaks() -> None:
    """Its places go 1 mm to and fro in a minute, by many times what they are said to err by."""
    rng, t = np.random.default_rng(0), np.arange(3600) / 60
    wander = np.convolve(rng.normal(0, 3e-5, len(t)), 0.998 ** np.arange(len(t)))[: len(t)]
    xy = np.stack([wander, wander[::-1]], axis=1) + rng.normal(0, 1e-4, (len(t), 2))
    assert np.abs(xy).max() < 0.002
    assert breaks(t, xy, np.full((len(t), 2), 1.5e-4)) == []
