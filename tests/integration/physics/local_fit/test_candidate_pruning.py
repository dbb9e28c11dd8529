"""Meetings of stones that go side by side: rows of stones in closed form, with noise."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.tracks import check_detections
from curlshot.physics.local_fit.candidate_pruning import MANY, prune_candidates
from curlshot.physics.local_fit.candidates import candidates
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.traces import traces
from curlshot.tests.helpers.physics.watch import NAMES, RADIUS

TWO = 2 * RADIUS


def row(hit: bool) -> pd.DataFrame:
    """Six stones that go up y side by side, almost touching; the first may come from behind.

    It hits the second at 1.5 s, which takes over its velocity.
    """
    rng, t = np.random.default_rng(3), np.arange(0, 3, 0.04)
    way = t - 0.05 * t**2
    tables = []
    for k, name in enumerate(NAMES):
        x, y = 1.001 * TWO * max(k - 1, 0), way + 0.0
        if k == 0:
            y = y - 1.001 * TWO if not hit else y - TWO + 0.4 * np.minimum(t - 1.5, 0)
        if k == 1 and hit:
            y = y + 0.4 * np.maximum(t - 1.5, 0)
        table = pd.DataFrame({"stone": name, "frame": np.arange(len(t)), "t": t})
        table["x"], table["y"] = (place + rng.normal(0, 0.003, len(t)) for place in (x, y))
        tables.append(table.assign(theta=np.nan, sd_x=0.003, sd_y=0.003, sd_theta=np.nan))
    return check_detections(pd.concat(tables))


def test_stones_that_go_together_hit_none() -> None:
    known = traces(row(hit=False))
    every = candidates(known, RADIUS)
    assert len(every) > MANY
    assert len(prune_candidates(every, known)) < len(every) / 4
    assert detect_hits(row(hit=False), RADIUS) == ()


def test_a_hit_among_stones_that_go_together_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("curlshot.physics.local_fit.candidate_pruning.MANY", 0)
    (hit,) = detect_hits(row(hit=True), RADIUS)
    assert {*hit.stones} == {"A", "B"}
    assert abs(hit.t - 1.5) < 4 * hit.stderr_t


def test_few_meetings_are_all_fitted() -> None:
    known = traces(row(hit=False))
    few = candidates(known, RADIUS)[:MANY]
    assert prune_candidates(few, known) == few
