from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from physics.local_fit.segments import Piece
from physics.local_fit.set_out import line, origin
from physics.local_fit.shot_fit import Meeting
from physics.local_fit.traces import Trace

T = np.linspace(2.0, 3.0, 21)
MEETINGS = [Meeting(2.4, ("A", "B"), 0.05)]


def trace() -> Trace:
    """A stone that glides by (0.3, -1.2) m/s from (1, 2) m at 2 s."""
    xy = np.array([1.0, 2.0]) + (T - 2.0)[:, None] * np.array([0.3, -1.2])
    sd = np.full_like(xy, 0.003)
    return Trace("A", T, xy, sd, np.full(21, np.nan), np.full(21, np.nan), 0 * xy)


def piece(samples: np.ndarray, **bounds: float | int | bool | None) -> Piece:
    plain = Piece("A", 2.4, 3.0, samples)
    return replace(plain, **bounds)  # type: ignore[arg-type]


def test_a_piece_begins_with_the_hit_that_opens_it() -> None:
    assert origin(piece(np.arange(9, 21), opens=0), trace(), MEETINGS) == 2.4


def test_a_piece_that_no_hit_opens_begins_with_its_first_sighting() -> None:
    assert origin(piece(np.arange(9, 21)), trace(), MEETINGS) == pytest.approx(2.45)


def test_a_piece_without_sightings_begins_or_ends_when_it_is_known_to() -> None:
    none = np.arange(0)
    assert origin(piece(none), trace(), MEETINGS) == 2.4
    assert origin(piece(none, start=-np.inf), trace(), MEETINGS) == 3.0


@pytest.mark.parametrize("samples", [np.arange(9, 21), np.arange(9, 10), np.arange(0)])
def test_a_line_is_found_by_however_few_sightings(samples: np.ndarray) -> None:
    place, velocity = line(piece(samples), trace(), 2.4)
    assert place == pytest.approx([1.12, 1.52])
    assert velocity == pytest.approx([0.3, -1.2])


def test_a_stone_at_rest_has_no_velocity() -> None:
    place, velocity = line(piece(np.arange(9, 12), rest=True), trace(), 2.4)
    assert place == pytest.approx([1.15, 1.4])
    assert not velocity.any()
