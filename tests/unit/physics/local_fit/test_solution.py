from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.segments import Piece
from curlshot.physics.local_fit.solution import LocalFit, Meeting

SIDES = {(0, "A"): (0, 1), (0, "B"): (2, 3)}
ORIGINS = np.array([0.0, 1.0, 0.0, 1.0])


def fit(cov: np.ndarray) -> LocalFit:
    """A comes up y at 2 m/s, slowed by 0.2 m/s², and hits B at the origin at 1 s."""
    pieces = tuple(
        Piece(stone, start, start + 1.0, np.arange(0))
        for stone, start in (("A", 0.0), ("A", 1.0), ("B", 0.0), ("B", 1.0))
    )
    states = [
        [0, 0, 0, -2.2, 2.0, -0.2], [0, 0, 0, -0.3, 0.2, -0.1],
        [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1.6, -0.1],
    ]  # fmt: skip
    even = np.zeros(4)  # the ice slows them alike at all speeds
    theta = np.concatenate([np.ravel(states), [1.0], even])
    return LocalFit(pieces, (Meeting(1.0, ("A", "B"), 0.02),), theta, cov, ORIGINS, 1.0, SIDES)


def test_states_at_a_hit_are_those_of_the_pieces_on_either_side() -> None:
    state = fit(np.zeros((29, 29))).contact_state(0)
    assert state.t == 1.0
    assert state.places == pytest.approx(np.array([[0.0, -0.3], [0.0, 0.0]]))
    assert state.before == pytest.approx(np.array([[0.0, 1.8], [0.0, 0.0]]))
    assert state.after == pytest.approx(np.array([[0.0, 0.2], [0.0, 1.6]]))
    assert state.normal == pytest.approx([0.0, 1.0])


def test_errors_are_handed_on_with_what_they_have_in_common() -> None:
    """vy of A before the hit is v + a τ: its variance has the covariance of v and a twice."""
    root = np.random.default_rng(4).normal(0, 0.01, (29, 29))
    cov = root @ root.T
    value, found = fit(cov).propagate([0], lambda states: states[0].before[0])
    row = np.zeros(29)
    row[[4, 5, 24]] = 1.0, 1.0, -0.2  # τ is 1 s; a later hit finds the stone slower
    row[25] = -0.2 * (9 * np.log(0.9) + 1)  # it would stop after 10 s
    assert value == pytest.approx([0.0, 1.8])
    assert found[1, 1] == pytest.approx(row @ cov @ row, rel=1e-4)


def test_a_motion_is_told_with_other_unknowns_too() -> None:
    shot = fit(np.zeros((29, 29)))
    other = shot.theta.copy()
    other[24] = 1.5
    place, speed = shot.motion(1, shot.time(0, other), other)
    assert place == pytest.approx([0.0, -0.3 + 0.2 * 0.5 - 0.05 * 0.25])
    assert speed == pytest.approx([0.0, 0.15])
