from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from physics.segments import breaks, cut
from physics.stretch import PLACE_MEMORY
from physics.traces import Trace
from tests.physics.watch import lasting


def trace(t: np.ndarray, y: np.ndarray, sd: float, seed: int = 0) -> Trace:
    rng = np.random.default_rng(seed)
    xy = np.column_stack([np.zeros_like(y), y]) + rng.normal(0, sd, (len(t), 2))
    nothing = np.full(len(t), np.nan)
    return Trace("A", t, xy, np.full((len(t), 2), sd), nothing, nothing, 0 * t)


T = np.arange(0, 4, 1 / 30)


def test_an_even_motion_has_no_breaks() -> None:
    for seed in range(10):
        one = trace(T, 1.5 * T - 0.05 * T**2, 0.005, seed)
        assert breaks(one.t, one.xy, one.sd) == []
        still = trace(T, 0 * T, 0.005, seed)
        assert breaks(still.t, still.xy, still.sd) == []


@settings(max_examples=20, deadline=None)
@given(when=st.floats(0.5, 3.5), before=st.floats(-1.5, 1.5), after=st.floats(-1.5, 1.5))
def test_a_kink_is_found_within_two_frames(when: float, before: float, after: float) -> None:
    if abs(before - after) < 0.4:
        return
    y = np.where(when > T, before * (T - when), after * (T - when))
    one = trace(T, y, 0.003)
    assert breaks(one.t, one.xy, one.sd) == pytest.approx([when], abs=2.5 / 30)


def test_errors_that_last_for_a_while_are_no_breaks_and_a_push_among_them_is_one() -> None:
    stated = np.full((len(T), 2), 0.0012)
    for seed in range(15):
        rng = np.random.default_rng(seed)
        one = trace(T, 1.5 * T - 0.05 * T**2, 0.0007, seed)
        for axis in range(2):
            one.xy[:, axis] += lasting(rng, T, 0.002, PLACE_MEMORY)
        assert breaks(one.t, one.xy, stated) == []
        one.xy[:, 1] -= np.maximum(0, 0.15 * (T - 2))
        assert breaks(one.t, one.xy, stated) == pytest.approx([2], abs=0.2)


def test_single_outliers_are_no_breaks() -> None:
    one = trace(T, 1.2 * T, 0.004)
    one.xy[[20, 55, 90]] += 0.3
    assert breaks(one.t, one.xy, one.sd) == []


def test_pieces_cover_every_sighting_once() -> None:
    y = np.where(T < 1, 0, np.where(T < 2, T - 1, 1 - 0.5 * (T - 2)))
    one = trace(T, y, 0.003)
    pieces = cut(one, [(4, 3.0)], 0.1455)
    assert np.array_equal(np.concatenate([p.samples for p in pieces]), np.arange(len(T)))
    assert [p.rest for p in pieces] == [True, False, False, False]
    assert [(p.opens, p.closes) for p in pieces] == [
        (None, None), (None, None), (None, 4), (4, None),
    ]  # fmt: skip


def test_a_glide_and_the_rest_that_it_ends_in_are_one_piece() -> None:
    slow, speed = 0.3, 0.6
    stop = speed / slow
    tau = np.minimum(T, stop)
    one = trace(T, speed * tau - 0.5 * slow * tau**2, 0.002)
    pieces = cut(one, [], 0.1455)
    assert len(pieces) == 1
    assert pieces[0].stops or len(pieces[0].samples) == len(T)
    assert not pieces[0].rest


def test_a_stone_at_rest_has_no_breaks_and_a_small_nudge_is_one() -> None:
    rng = np.random.default_rng(8)
    t, sd = np.arange(300) / 30, np.full((300, 2), 1e-3)
    for _ in range(20):
        xy = rng.normal(0, 1e-3, (300, 2))
        assert breaks(t, xy, sd) == []
        xy[150:, 1] += 0.006
        assert breaks(t, xy, sd) == pytest.approx([t[150]], abs=0.2)
