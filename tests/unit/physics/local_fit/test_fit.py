from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.physics.local_fit.fit import _first_guess, _origin, fit_shot
from curlshot.physics.local_fit.hit_detection import cut_all
from curlshot.physics.local_fit.segments import Piece
from curlshot.physics.local_fit.solution import Deceleration, Meeting
from curlshot.physics.local_fit.traces import Trace, traces
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch

T = np.linspace(2.0, 3.0, 21)
MEETINGS = [Meeting(2.4, ("A", "B"), 0.05)]


def test_exact_detections_give_the_exact_hit() -> None:
    motion = hit_motion(1.5, 0.1)
    known = traces(watch(motion, np.random.default_rng(61), sd=1e-6))
    meetings = [Meeting(1.01, ("A", "B"), 1 / 30)]
    pieces, _ = cut_all(known, meetings, RADIUS)
    fit = fit_shot(known, pieces, meetings, RADIUS)
    state, hit = fit.contact_state(0), motion.hits[0]
    assert state.t == pytest.approx(hit.t, abs=1e-4)
    assert np.allclose(state.normal, hit.normal, atol=1e-3)
    assert np.allclose(state.before, [v[:2] for v in hit.before], atol=2e-3)
    assert np.allclose(state.after, [v[:2] for v in hit.after], atol=2e-3)


def test_momentum_is_held_only_when_asked_for() -> None:
    known = traces(watch(hit_motion(), np.random.default_rng(62), sd=0.01))
    meetings = [Meeting(1.0, ("A", "B"), 1 / 30)]
    pieces, _ = cut_all(known, meetings, RADIUS)
    changes = []
    for momentum in (True, False):
        fit = fit_shot(
            known, pieces, meetings, RADIUS,
            deceleration=Deceleration(0.1, 0.05, 0.05), momentum=momentum,
        )  # fmt: skip
        state = fit.contact_state(0)
        changes.append(float(np.hypot(*np.sum(state.after - state.before, axis=0))))
    assert changes[0] < 0.1 * changes[1]


def trace() -> Trace:
    """A stone that glides by (0.3, -1.2) m/s from (1, 2) m at 2 s."""
    xy = np.array([1.0, 2.0]) + (T - 2.0)[:, None] * np.array([0.3, -1.2])
    sd = np.full_like(xy, 0.003)
    return Trace("A", T, xy, sd, np.full(21, np.nan), np.full(21, np.nan), 0 * xy, 0 * xy)


def piece(samples: np.ndarray, **bounds: float | int | bool | None) -> Piece:
    plain = Piece("A", 2.4, 3.0, samples)
    return replace(plain, **bounds)  # type: ignore[arg-type]


def test_a_piece_begins_with_the_hit_that_opens_it() -> None:
    assert _origin(piece(np.arange(9, 21), opens=0), trace(), MEETINGS) == 2.4


def test_a_piece_that_no_hit_opens_begins_with_its_first_detection() -> None:
    assert _origin(piece(np.arange(9, 21)), trace(), MEETINGS) == pytest.approx(2.45)


def test_a_piece_without_detections_begins_or_ends_when_it_is_known_to() -> None:
    none = np.arange(0)
    assert _origin(piece(none), trace(), MEETINGS) == 2.4
    assert _origin(piece(none, start=-np.inf), trace(), MEETINGS) == 3.0


def test_a_rest_is_told_at_the_hit_that_ends_it() -> None:
    assert _origin(piece(np.arange(9, 21), rest=True, closes=0), trace(), MEETINGS) == 2.4


@pytest.mark.parametrize("rests", [2.0, 200.0])
def test_a_glide_is_guessed_alike_however_long_its_stone_rests_in_the_end(rests: float) -> None:
    t = np.arange(0, 5 + rests, 0.04)
    tau = np.minimum(t, 5.0)
    xy = np.outer(0.5 * tau - 0.05 * tau**2, [0.6, 0.8])
    none = np.full(len(t), np.nan)
    one = Trace("A", t, xy, np.full(xy.shape, 1e-3), none, none, 0 * xy, 0 * xy)
    state = _first_guess(Piece("A", 0.0, np.inf, np.arange(len(t)), stops=True), one, 0.0)
    assert state[:, 0] == pytest.approx([0.0, 0.0], abs=0.05)
    assert state[:, 1] == pytest.approx([0.3, 0.4], rel=0.02)
    assert state[:, 2] == pytest.approx([-0.06, -0.08], rel=0.04)


@pytest.mark.parametrize("samples", [np.arange(9, 21), np.arange(9, 10), np.arange(0)])
def test_a_line_is_found_by_however_few_detections(samples: np.ndarray) -> None:
    place, velocity, acceleration = _first_guess(piece(samples), trace(), 2.4).T
    assert place == pytest.approx([1.12, 1.52])
    assert velocity == pytest.approx([0.3, -1.2])
    assert not acceleration.any()


def test_a_stone_at_rest_has_no_velocity() -> None:
    state = _first_guess(piece(np.arange(9, 12), rest=True), trace(), 2.4)
    assert state[:, 0] == pytest.approx([1.15, 1.4])
    assert not state[:, 1:].any()
