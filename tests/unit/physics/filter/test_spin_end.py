"""Spins that end at once as a stone comes to rest: angles in closed form."""

import numpy as np
import pytest

from curlshot.physics.filter.rate_filter import filtered
from curlshot.physics.filter.spin_end import spin_ends
from curlshot.physics.filter.stretch import Model, Stretch

RATE, REST, SD = 25.0, 3.0, 0.015


def _angles(kind: str, end: float, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, angles with noise, and true spins: 1.3 rad/s at first."""
    t = np.arange(0.0, 5.0, 1 / RATE)
    past = np.maximum(t - end, 0.0)
    if kind == "at once":
        theta, spin = 1.3 * np.minimum(t, end), np.where(t < end, 1.3, 0.0)
    elif kind == "on the spot":  # goes on, 1 rad/s² less and less
        slow = np.minimum(past, 1.3)
        theta, spin = 1.3 * np.minimum(t, end) + 1.3 * slow - 0.5 * slow**2, 1.3 - slow
    else:  # has fallen to nothing when the stone rests
        left = np.maximum(end - t, 0.0)
        theta, spin = -0.5 * 1.3 / end * left**2, 1.3 * left / end
    return t, theta + np.random.default_rng(seed).normal(0, SD, len(t)), spin


@pytest.mark.parametrize("end", [2.85, 3.0, 3.12])
@pytest.mark.parametrize("seed", range(5))
def test_tells_where_a_spin_ends_at_once(end: float, seed: int) -> None:
    t, theta, _ = _angles("at once", end, seed)
    ends = spin_ends(t, theta, np.full_like(t, SD), t > REST)
    assert ends.sum() == 1
    assert t[np.flatnonzero(ends)[0]] == pytest.approx(end, abs=1.5 / RATE)


@pytest.mark.parametrize("kind", ["on the spot", "falling"])
@pytest.mark.parametrize("seed", range(5))
def test_leaves_spins_that_change_steadily(kind: str, seed: int) -> None:
    t, theta, _ = _angles(kind, 3.0, seed)
    assert not spin_ends(t, theta, np.full_like(t, SD), t > REST).any()


def test_says_nothing_without_angles_or_without_rest() -> None:
    t, theta, _ = _angles("at once", 3.0, 0)
    sd = np.full_like(t, SD)
    assert not spin_ends(t, theta, sd, np.zeros(len(t), bool)).any()
    assert not spin_ends(t, np.full_like(t, np.nan), sd, t > REST).any()


def test_takes_angles_without_noise() -> None:
    t, nothing = np.arange(0.0, 5.0, 1 / RATE), np.zeros(125)
    ended = 1.3 * np.minimum(t, REST)
    assert spin_ends(t, ended, nothing, t > REST).sum() == 1
    for steady in (nothing + 0.3, 0.7 * t, 0.7 * t - 0.05 * t**2):
        assert not spin_ends(t, steady, nothing, t > REST).any()


@pytest.mark.parametrize("seed", range(3))
def test_a_filter_keeps_a_spin_up_to_its_end(seed: int) -> None:
    t, theta, spin = _angles("at once", 3.0, seed)
    moving = np.where(t < REST, 0.1 * (REST - t), 0.0)
    y = -0.05 * np.maximum(REST - t, 0) ** 2
    n, errors = len(t), np.full((len(t), 3), SD)
    errors[:, :2] = 0.001
    mean, spread, _ = filtered(
        Stretch(
            t, np.column_stack([0 * t, y, theta]), errors, np.zeros((n, 3)), np.zeros(n, int),
            t > REST, np.zeros(n, bool), np.column_stack([0 * t, moving]), Model(0.1, 0.01),
        )
    )  # fmt: skip
    turning = (t > REST - 0.4) & (t < REST - 0.02)
    off = (mean[:, 5] - spin)[turning]
    assert np.sqrt(np.mean(off**2)) < 0.08  # 0.17 to 0.21 where the end is rounded off
    assert np.mean(np.abs(off) < 2 * spread[turning, 5]) > 0.9
