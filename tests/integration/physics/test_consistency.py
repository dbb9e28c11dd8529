"""Whether the filter's errors are as large as it says: innovations and errors, squared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2

from curlshot.physics.filter.rate_filter import filtered, forward
from curlshot.physics.filter.stretch import (
    ANGLE_MEMORY,
    PLACE_MEMORY,
    Model,
    Smoothed,
    Steps,
    Stretch,
    drift,
    steps,
)  # fmt: skip
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.tests.helpers.physics.watch import (
    RADIUS,
    airtable,
    hit_motion,
    lasting,
    semireal,
    watch,
)

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
    gliding = np.tile([1.0, 0.0], (n, 1))
    sd = rng.uniform([0.001, 0.001, 0.005], [0.01, 0.01, 0.05], (n, 3))
    slow = np.tile(rng.uniform(0, [0.01, 0.01, 0.05]), (n, 1))
    calm = np.zeros(n, bool)
    stretch = Stretch(
        t, np.zeros((n, 3)), sd, slow, np.zeros(n, int), calm, calm, gliding, Model(0.0, 0.05)
    )
    along, turning = steps(stretch)
    x, y = (path(rng, along, *rng.normal(0, [3.0, 1.0])) for _ in range(2))
    theta = path(rng, turning, *rng.normal(0, [3.0, 2.0]))
    truth = np.column_stack([x[:, 0], y[:, 0], x[:, 1], y[:, 1], theta])
    truth += drift(replace(stretch, z=truth[:, SEEN]), along, turning)
    memories = (PLACE_MEMORY, PLACE_MEMORY, ANGLE_MEMORY)
    errors = [lasting(rng, t, slow[0, k], memory) for k, memory in enumerate(memories)]
    z = truth[:, SEEN] + np.column_stack(errors) + rng.normal(0, sd)
    z[1 + rng.choice(n - 1, n // 10), :2] = np.nan
    z[1 + rng.choice(n - 1, n // 10), 2] = np.nan
    return replace(stretch, z=z), truth


def within_bounds(values: Floats, checks: int = 1) -> bool:
    """Whether the sum of squares lies within the 95 % bounds of its χ², one of several checks."""
    told = values[np.isfinite(values)]
    tail = 0.025 / checks
    low, high = chi2.ppf([tail, 1 - tail], len(told))
    return bool(low < np.sum(told**2) < high)


def test_innovations_are_as_large_as_expected() -> None:
    rng = np.random.default_rng(51)
    found = np.concatenate([forward(drawn(rng)[0]).normalised_innovations[5:] for _ in range(25)])
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


def stretches_of(seen: pd.DataFrame, radius: float = RADIUS) -> list[Stretch]:
    """What the filter is given of the stones of a shot while they move."""
    kept: list[Stretch] = []

    def spy(stretch: Stretch) -> Smoothed:
        kept.append(stretch)
        return filtered(stretch)

    smooth(seen, detect_hits(seen, radius), radius=radius, run=spy)
    return [stretch for stretch in kept if not stretch.rest.any()]


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("slow", [0.0, 0.004])
def test_innovations_of_a_shot_are_as_large_as_expected(stated: bool, slow: float) -> None:
    # How its detections err is not told, or only in part.
    each = []
    for seed in range(61, 67):
        rng = np.random.default_rng(seed)
        seen = watch(hit_motion(1.2, 0.08, after=1.2), rng, sd=0.004, given=stated)
        for _, group in seen.groupby("stone"):
            for column in ("x", "y"):
                t = group["t"].to_numpy()
                off = lasting(rng, t, slow, PLACE_MEMORY)
                seen.loc[group.index, column] += off
        each += [forward(stretch).normalised_innovations[6:] for stretch in stretches_of(seen)]
    found = np.concatenate(each)
    assert len(found) > 200
    for axis in range(3):
        told = found[np.isfinite(found[:, axis]), axis]
        # What the ice may do is more than it does here, and how detections err is not quite known.
        low, high = chi2.ppf([0.025, 0.975], len(told)) / len(told)
        assert 0.9 * low < np.mean(told**2) < 1.1 * high


def test_innovations_of_imported_tracks_are_as_large_as_expected(shared: Path) -> None:
    rng = np.random.default_rng(64)
    for seen, radius in (
        (semireal(shared, "lgt_glancing", rng, sd=0.003, slow=0.003), RADIUS),
        (airtable(shared), 0.035),  # marked by a program; nobody knows how it errs
    ):
        moving = [each for each in stretches_of(seen, radius) if len(each.t) > 12]
        each = [forward(stretch).normalised_innovations[6:, :2] for stretch in moving]
        assert 0.6 < np.nanmean(np.concatenate(each) ** 2) < 1.7
        # Each for its own size, or a short one with large innovations would speak for all.
        products = [told[1:] * told[:-1] / np.nanmean(told**2) for told in each]
        assert abs(np.nanmean(np.concatenate(products))) < 0.15
