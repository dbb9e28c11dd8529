from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.segments import cut
from curlshot.tests.helpers.physics.segments import trace

T = np.arange(0, 4, 1 / 30)


def test_pieces_cover_every_detection_once() -> None:
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


@pytest.mark.parametrize("hidden", [(1.0, 1.5), (1.21, 1.45)])
def test_a_stone_that_rests_elsewhere_once_it_was_hidden_rests_twice(
    hidden: tuple[float, float],
) -> None:
    """It goes from 1.2 s on and lies 19 cm farther at 1.5 s; some of the way may be seen."""
    share = np.clip((T - 1.2) / 0.3, 0, 1)
    y = 0.19 * (1 - (1 - share) ** 2)
    seen = (hidden[0] >= T) | (hidden[1] <= T)
    before, after = cut(trace(T[seen], y[seen], 0.001), [], 0.1455)
    assert before.rest and after.rest
    assert hidden[0] < before.end == after.start < hidden[1]


@pytest.mark.parametrize("stray", [20, 52, 68, 100])
def test_a_stray_does_not_shift_where_two_rests_part(stray: int) -> None:
    """One detection before, or one after, is taken for the stone and shows another at its place."""
    y = np.where(T < 2, 0.0, 0.3)
    y[stray] = 0.3 - y[stray]
    seen = (T < 1.8) | (T > 2.2)
    before, after = cut(trace(T[seen], y[seen], 0.001), [], 0.1455)
    assert len(before.samples) == (T < 1.8).sum()
    assert 1.8 < before.end == after.start < 2.2


@pytest.mark.parametrize(("off", "sd"), [(0.01, 0.001), (0.07, 0.01)])
def test_a_stone_that_is_seen_elsewhere_by_what_light_or_noise_does_rests_once(
    off: float, sd: float
) -> None:
    (piece,) = cut(trace(T, np.where(T < 2, 0.0, off), sd), [], 0.1455)
    assert piece.rest
