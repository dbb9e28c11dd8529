"""Whether the filter's errors are as large as it says: innovations and errors, squared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from physics.contacts import find_contacts
from physics.kalman import smooth
from physics.rate_filter import filtered
from physics.stretch import Estimates, Model, Steps, Stretch, steps
from tests.physics.watch import RADIUS, hit_motion, watch

Floats = NDArray[np.float64]

SEEN = [0, 1, 4]
"""Ranks of x, y and θ in the state."""


def path(rng: np.random.Generator, way: Steps, place: float, rate: float) -> Floats:
    """Places and rates as the filter expects them to go on, shape (n, 2)."""
    out = [(place, rate)]
    for reach, keep, q00, q01, q11 in zip(
        way.reach, way.keep, way.q00, way.q01, way.q11, strict=True
    ):
        noise = rng.multivariate_normal([0.0, 0.0], [[q00, q01], [q01, q11]])
        place, rate = place + reach * rate + noise[0], keep * rate + noise[1]
        out.append((place, rate))
    return np.array(out)


def drawn(rng: np.random.Generator, n: int = 30) -> tuple[Stretch, Floats]:
    """A stretch whose truth (n, 6) moves and is seen by the filter's own laws."""
    t = np.cumsum(rng.uniform(0.02, 0.06, n))
    nowhere = np.zeros((n, 2))
    sd = rng.uniform([0.001, 0.001, 0.005], [0.01, 0.01, 0.05], (n, 3))
    calm = np.zeros(n, bool)
    model = Model(0.0, 0.05, 1.0)
    stretch = Stretch(t, np.zeros((n, 3)), sd, np.zeros(n, int), calm, calm, nowhere, model)
    along, turning = steps(stretch)
    x, y = (path(rng, along, *rng.normal(0, [3.0, 1.0])) for _ in range(2))
    theta = path(rng, turning, *rng.normal(0, [3.0, 2.0]))
    truth = np.column_stack([x[:, 0], y[:, 0], x[:, 1], y[:, 1], theta])
    z = truth[:, SEEN] + rng.normal(0, sd)
    z[1 + rng.choice(n - 1, n // 10), :2] = np.nan
    z[1 + rng.choice(n - 1, n // 10), 2] = np.nan
    return replace(stretch, z=z), truth


def innovations(stretch: Stretch, first: int) -> Floats:
    """Normalised innovations of x, y and θ from the time `first` on; NaN where not seen.

    What the filter expects at a time is what it says of it when it has not seen it yet.
    """
    out = []
    for k in range(first, len(stretch.t)):
        blind = stretch.z[: k + 1].copy()
        blind[k] = np.nan
        if not np.isfinite(blind[:, 0]).any():
            continue
        each = {
            name: getattr(stretch, name)[: k + 1]
            for name in ("t", "sd", "piece", "rest", "idle", "speed")
        }
        mean, spread, _ = filtered(replace(stretch, z=blind, **each))
        size = np.hypot(spread[k, SEEN], stretch.sd[k])
        out.append((stretch.z[k] - mean[k, SEEN]) / size)
    return np.array(out).reshape(-1, 3)


def within_bounds(values: Floats, checks: int = 1) -> bool:
    """Whether the sum of squares lies within the 95 % bounds of its χ², one of several checks."""
    told = values[np.isfinite(values)]
    tail = 0.025 / checks
    low, high = chi2.ppf([tail, 1 - tail], len(told))
    return bool(low < np.sum(told**2) < high)


def test_innovations_are_as_large_as_expected() -> None:
    rng = np.random.default_rng(51)
    found = np.concatenate([innovations(drawn(rng)[0], 5) for _ in range(25)])
    assert len(found) > 500
    assert all(within_bounds(found[:, axis], checks=3) for axis in range(3))
    white = found[1:] * found[:-1]
    told = white[np.isfinite(white)]
    assert abs(told.mean()) < 3 / np.sqrt(len(told))


def test_errors_are_as_large_as_stated() -> None:
    rng = np.random.default_rng(52)
    pulls = []
    for _ in range(150):
        stretch, truth = drawn(rng)
        mean, spread, _ = filtered(stretch)
        pulls.append(((mean - truth) / spread)[[0, 15, 29]])
    errors = np.array(pulls)
    assert all(within_bounds(errors[:, k, axis], 18) for k in range(3) for axis in range(6))


def stretches_of(seed: int) -> list[Stretch]:
    """What the filter is given of a simulated shot that is seen with white noise."""
    kept: list[Stretch] = []

    def spy(stretch: Stretch) -> Estimates:
        kept.append(stretch)
        return filtered(stretch)

    seen = watch(hit_motion(1.2, 0.08, after=1.2), np.random.default_rng(seed), sd=0.006)
    smooth(seen, find_contacts(seen, RADIUS), radius=RADIUS, run=spy)
    return kept


def test_innovations_of_a_shot_are_no_larger_than_expected() -> None:
    # Its sightings are known; what the ice may do is more than it does here.
    each = [
        innovations(stretch, 6)
        for seed in (61, 62)
        for stretch in stretches_of(seed)
        if not stretch.rest.any()
    ]
    square = np.concatenate(each) ** 2
    told = square[np.isfinite(square)]
    low, high = chi2.ppf([0.025, 0.975], len(told)) / len(told)
    assert 0.8 * low < told.mean() < high
