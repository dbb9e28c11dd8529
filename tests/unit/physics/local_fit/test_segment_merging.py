from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from curlshot.physics.local_fit.breaks import breaks
from curlshot.physics.local_fit.segment_merging import glide_cost, merge_segments
from curlshot.synthetic.physics import Ice, Start, simulate

T = np.arange(0, 5, 1 / 30)
SD = 0.002


def slow_glide() -> NDArray[np.float64]:
    """Ways up y of a stone that FCV1's ice slows from 0.8 to 0.1 m/s."""
    ice = Ice(b=0.0084, a=0.0027, v_c=0.0639)
    motion = simulate([Start(0, 0, 0, 0.8, 0, 0)], 5.1, ice=ice, step=5e-4, keep_every=4)
    places: NDArray[np.float64] = motion.at(T)[:, 0, 1]
    return places


def seen(y: NDArray[np.float64], seed: int) -> NDArray[np.float64]:
    rng = np.random.default_rng(seed)
    return np.column_stack([0 * y, y]) + rng.normal(0, SD, (len(y), 2))


def test_a_glide_is_not_cut_where_ice_slows_it_the_more_the_slower_it_is() -> None:
    y = slow_glide()
    for seed in range(8):
        assert breaks(T, seen(y, seed), np.full((len(T), 2), SD)) == []


def test_a_push_in_such_a_glide_is_a_break() -> None:
    y = slow_glide() + 0.15 * np.maximum(T - 2.5, 0)
    for seed in range(8):
        found = breaks(T, seen(y, seed), np.full((len(T), 2), SD))
        assert found == pytest.approx([2.5], abs=0.25)


def test_neighbours_are_joined_until_a_cut_pays() -> None:
    y = slow_glide() + 0.3 * np.maximum(T - 2.5, 0)
    variance = np.full(len(T), SD**2)
    assert merge_segments(T, seen(y, 1), variance, [30, 75, 120], 12.0) == [75]
    assert merge_segments(T, seen(y, 1), variance, [], 12.0) == []


def test_places_that_are_no_glide_at_all_cost_without_end() -> None:
    y = np.where(T < 2.5, 0.0, 10 * (T - 2.5))
    assert glide_cost(T, seen(y, 0), np.full(len(T), SD**2)) == np.inf
    assert glide_cost(T[:3], seen(y, 0)[:3], np.full(3, SD**2)) == np.inf
