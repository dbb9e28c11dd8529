from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.physics.filter import rate_filter, reference_filter
from curlshot.physics.filter.stretch import SPIN_LOSS, Model, Stretch
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.tests.helpers.physics.rate_filter import random_stretch
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_tracks_are_the_same_by_either_filter() -> None:
    seen = watch(hit_motion(1.2, 0.08, after=1.5), np.random.default_rng(5), sd=0.006)
    contacts = detect_hits(seen, RADIUS)
    fast = smooth(seen, contacts, radius=RADIUS)
    slow = smooth(seen, contacts, radius=RADIUS, run=reference_filter.filtered)
    numbers = fast.columns.drop(["stone", "team"])
    np.testing.assert_allclose(fast[numbers], slow[numbers], rtol=1e-9, atol=1e-9)


def test_a_steady_motion_is_found_exactly() -> None:
    t = np.arange(40) / 25
    loss = SPIN_LOSS / np.hypot(0.5, 0.3)
    z = np.column_stack([1 + 0.5 * t, 2 - 0.3 * t, 0.7 * t - 0.5 * loss * t**2])
    n = len(t)
    stretch = Stretch(
        t, z, np.full((n, 3), 1e-3), np.zeros((n, 3)), np.zeros(n, int), *np.zeros((2, n), bool),
        np.tile([0.5, -0.3], (n, 1)), Model(0.0, 0.02),
    )  # fmt: skip
    mean, spread, seen = rate_filter.filtered(stretch)
    np.testing.assert_allclose(mean[:, :2], z[:, :2], atol=1e-5)
    np.testing.assert_allclose(mean[:, 2:4], [[0.5, -0.3]] * n, atol=1e-4)
    np.testing.assert_allclose(mean[:, 5], 0.7 - loss * t, atol=1e-4)
    assert seen.all()
    assert spread[20, 0] < 0.6 * spread[0, 0] < 1e-3
    assert spread[0, 2] == pytest.approx(spread[-1, 2], rel=0.05)


@pytest.mark.parametrize("seed", range(4))
def test_an_error_of_angles_is_smoothed_as_angles_are(seed: int) -> None:
    """Angles with and without it differ by what it is said to come to."""
    rng = np.random.default_rng(seed)
    n = 40
    stretch = replace(
        random_stretch(rng, n), rest=np.zeros(n, bool), idle=np.zeros(n, bool),
        speed=np.tile([2.0, 0.0], (n, 1)),
    )  # fmt: skip
    stretch.z[:, 2] = 1.5 * stretch.t + rng.normal(0, 0.01, n)
    stretch.z[rng.random(n) < 0.2, 2] = np.nan
    shared = 0.02 * np.column_stack([np.sin(stretch.t), np.cos(1.7 * stretch.t)])
    told = rate_filter.angle_response(stretch, shared)
    assert told.shape == (n, 2, 2)
    before = reference_filter.filtered(stretch)[0]
    for k, error in enumerate(shared.T):
        off = stretch.z + np.outer(error, [0, 0, 1])
        after = reference_filter.filtered(replace(stretch, z=off))[0]
        np.testing.assert_allclose(told[:, :, k], (after - before)[:, 4:], atol=1e-6)


def test_angles_that_are_off_by_as_much_throughout_tell_the_same_spin() -> None:
    stretch = random_stretch(np.random.default_rng(1), 30)
    told = rate_filter.angle_response(stretch, np.full((30, 1), 0.1))
    np.testing.assert_allclose(told[:, 1, 0], 0.0, atol=1e-4)
    assert not rate_filter.angle_response(stretch, np.zeros((30, 1))).any()


def test_a_stone_at_rest_has_no_spin_to_be_off() -> None:
    stretch = random_stretch(np.random.default_rng(2), 60)
    shared = np.random.default_rng(3).normal(0, 0.1, (60, 2))
    assert stretch.idle.any()
    assert not rate_filter.angle_response(stretch, shared)[stretch.idle, 1].any()
