from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from curlshot.physics.local_fit.candidates import _extent, _through_gaps, candidates
from curlshot.physics.local_fit.traces import Trace, traces
from curlshot.synthetic.physics import Start
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def straight(name: str, place: tuple[float, float], velocity: tuple[float, float]) -> Trace:
    """A stone that keeps its velocity, seen 30 times a second for two seconds."""
    t = np.arange(60) / 30
    xy = np.array(place) + t[:, None] * np.array(velocity)
    none = np.full(60, np.nan)
    return Trace(
        name, t, xy, np.full((60, 2), 1e-3), none, none, np.zeros((60, 2)), np.zeros((60, 2))
    )


@pytest.mark.parametrize(("beside", "count"), [(0.0, 1), (0.28, 1), (0.4, 0), (0.6, 0)])
def test_paths_within_reach_are_candidates_at_their_nearest(beside: float, count: int) -> None:
    # They pass each other at t = 0.5 s, whatever else they do.
    paths = {
        "A": straight("A", (0.0, -0.5), (0.0, 1.0)),
        "B": straight("B", (beside, 0.5), (0.0, -1.0)),
    }
    found = candidates(paths, RADIUS)
    assert len(found) == count
    for meeting in found:
        assert meeting.stones == ("A", "B")
        assert meeting.t == pytest.approx(0.5, abs=0.04)


@pytest.mark.parametrize(("turned", "count"), [(1.1, 1), (0.7, 0), (1.6, 0)])
def test_ways_that_cross_beside_a_gap_do_not_cross_in_it(turned: float, count: int) -> None:
    every = np.arange(0, 2.5, 0.04)
    t = every[(every < 1.0) | (every > 1.3)]
    late = np.maximum(t - turned, 0.0)
    apart = np.column_stack([0.3 + 0.5 * late, 0.8 - 0.7 * t + 1.2 * late])
    times, places = _through_gaps(t, apart, np.diff(t) > 0.1)
    assert len(times) == len(places) == len(t) + count
    assert np.all(np.diff(times) > 0)
    if count:
        (rank,) = np.flatnonzero(~np.isin(times, t))
        assert times[rank] == pytest.approx(turned)
        assert places[rank] == pytest.approx((0.3, 0.8 - 0.7 * turned))


def test_ways_through_a_gap_are_told_by_several_detections_but_not_by_an_earlier_hit() -> None:
    every = np.arange(0, 2.5, 0.04)
    t = every[(every < 1.0) | (every > 1.3)]
    early, late = np.minimum(t - 0.7, 0.0), np.maximum(t - 1.1, 0.0)
    apart = np.column_stack(
        [0.3 - 2.0 * early + 0.5 * late, 0.8 - 0.7 * t + 2.0 * early + 1.2 * late]
    )
    for seed in range(30):
        noise = np.random.default_rng(seed).normal(0, 0.004, apart.shape)
        times, _ = _through_gaps(t, apart + noise, np.diff(t) > 0.1)
        assert times[~np.isin(times, t)] == pytest.approx([1.1], abs=0.026)


def test_places_too_few_or_at_the_ends_tell_no_way_through_a_gap() -> None:
    for t in ([0.0, 0.04, 0.08], [0.0, 1.0, 1.04, 1.08], [0.0, 0.04, 0.08, 1.0]):
        apart = np.column_stack([t, np.square(t)])
        times, places = _through_gaps(np.array(t), apart, np.diff(t) > 0.1)
        assert times.tolist() == t
        assert places is apart


def test_stones_that_rest_side_by_side_never_meet() -> None:
    paths = {
        "A": straight("A", (0.0, 0.0), (0.0, 0.0)),
        "B": straight("B", (2 * RADIUS, 0.0), (0.0, 0.0)),
    }
    assert candidates(paths, RADIUS) == []


def test_candidates_of_a_row_come_in_the_order_of_cause() -> None:
    # A strikes B, which touches C: the hit of B and C cannot come before.
    motion = hit_motion(1.5, 0.02, others=(Start(0.0, 2 * RADIUS + 0.002),))
    found = candidates(traces(watch(motion, np.random.default_rng(3), sd=0.003)), RADIUS)
    pairs = [meeting.stones for meeting in found]
    assert pairs.index(("A", "B")) < pairs.index(("B", "C"))
    assert all(one.t <= two.t for one, two in pairwise(found))


def test_a_hit_is_passed_on_among_stones_that_touch() -> None:
    """B and C move on together for long after the hit: nearest they are at any time of that."""
    t = np.arange(0, 2, 0.04)
    late = np.maximum(t - 1.0, 0.0)
    up = {
        "A": np.where(t < 1.0, 1.5 * (t - 1.0), 0.1 * late) - 2 * RADIUS,
        "B": 0.2 * late,
        "C": 2 * RADIUS + 0.2 * late,
        "D": 4 * RADIUS + 1.0 * late,
    }
    noise = np.random.default_rng(1)
    none = np.full(len(t), np.nan)
    paths = {
        name: Trace(
            name, t, np.column_stack([0 * t, y]) + noise.normal(0, 1e-3, (len(t), 2)),
            np.full((len(t), 2), 1e-3), none, none, np.zeros((len(t), 2)), np.zeros((len(t), 2)),
        )
        for name, y in up.items()
    }  # fmt: skip
    found = [m for m in candidates(paths, RADIUS) if abs(m.t - 1.0) < 0.06]
    first = [m.stones for m in found]
    assert first.index(("A", "B")) < first.index(("B", "C")) < first.index(("C", "D"))


@pytest.mark.parametrize("wild", [0, 3])
def test_a_stone_moves_however_long_it_rests_and_not_by_a_few_wild_places(wild: int) -> None:
    rng = np.random.default_rng(5)
    t = np.arange(9000) / 25
    way = np.clip(t - 60.0, 0.0, 0.5) * 0.6
    xy = rng.normal(0, 0.002, (len(t), 2))
    xy[100 : 100 + wild] += 0.5
    none = np.full(len(t), np.nan)
    rests = Trace(
        "A",
        t,
        xy,
        np.full((len(t), 2), 2e-3),
        none,
        none,
        np.zeros((len(t), 2)),
        np.zeros((len(t), 2)),
    )
    assert _extent(rests) < 0.1 * RADIUS
    moved = replace(rests, xy=xy + np.column_stack([way, 0 * way]))
    assert _extent(moved) == pytest.approx(0.3, abs=0.02)
