"""Hits out of sight, and soft ones, that are not told are said; nothing else is."""

from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.tests.helpers.physics.untold import FPS, E, R, glide, hit, said, table


@pytest.mark.parametrize(
    "hidden",
    [
        {"A": (1.0, 2.6), "B": (1.0, 2.2)},
        {"A": (0.6, 2.6)},
        {"A": (1.3, 3.2), "B": (0.4, 1.9)},
    ],
)
def test_hit_in_long_gaps_is_found(hidden: dict[str, tuple[float, float]]) -> None:
    detections = table(*hit(1.0), hidden)
    (contact,) = detect_hits(detections, R)
    assert set(contact.stones) == {"A", "B"}
    assert contact.t == pytest.approx(1.5, abs=4 * contact.stderr_t + 0.005)
    local = estimate_locally(detections, [contact], radius=R)
    value, stderr = local.restitution.value, local.restitution.stderr
    assert value is not None and stderr is not None
    assert abs(value - E) < 3 * stderr and stderr < 0.1
    assert said(detections) == []


@pytest.mark.parametrize("hidden", [{}, {"A": (0.5, 2.4)}, {"A": (0.5, 2.4), "B": (0.7, 2.0)}])
def test_near_miss_says_nothing(hidden: dict[str, tuple[float, float]]) -> None:
    t, places = hit(1.0)
    start = np.array([2 * R + 0.02, 1.6])
    places["A"] = glide(start, np.array([0.0, -1.15]), t)
    places["B"] = np.zeros((len(t), 2))
    detections = table(t, places, hidden)
    assert detect_hits(detections, R) == ()
    assert said(detections) == []


def test_stone_that_light_moves_a_little_says_nothing() -> None:
    t, places = hit(1.0)
    places["C"][t > 2.0] += [0.006, 0.0]
    detections = table(t, places, {})
    assert said(detections) == []
    places["C"] = np.where(
        (t > 2.0)[:, None], glide(places["C"][0], np.array([0.3, 0.0]), t - 2.0), places["C"][0]
    )
    (text,) = said(table(t, places, {}))
    assert "the velocity of C changes at 2.0" in text


@pytest.mark.parametrize("step", [0.4, 0.6, 1.0])
def test_tables_marked_once_in_a_while_say_nothing_of_a_hit_that_is_told(step: float) -> None:
    t, places = hit(1.0, at=4.0, end=14.0)
    detections = table(t, places, {})
    few = detections[detections["frame"] % round(step * FPS) == 0].reset_index(drop=True)
    assert len(detect_hits(few, R)) == 1
    assert not any("motion of" in text or "hit" in text for text in said(few))
