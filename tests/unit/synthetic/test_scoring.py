"""The scores of tracks against truth by which clips are judged."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from curlshot.synthetic.scoring import read_truth, score_tracks

TRUTH = pd.DataFrame(
    {"stone": ["A", "B"], "frame": 0, "x": [0.0, 1.0], "y": [0.0, 1.0], "visible": 1.0}
)
FOUND = pd.DataFrame(
    {
        "stone": ["p", "q"], "frame": 0, "x": [0.0015, 1.0], "y": [0.0025, 1.005],
        "sd_x": 0.001, "sd_y": 0.001, "seen": 1,
    }
)  # fmt: skip


def test_coverage_is_of_each_axis_and_knows_what_the_truth_is_good_for() -> None:
    assert score_tracks(FOUND, TRUTH).within_two_sd == 0.5  # 1.5 and 2.5, 0 and 5 errors off
    assert score_tracks(FOUND, TRUTH.assign(sd=0.001)).within_two_sd == 0.75
    assert score_tracks(FOUND, TRUTH.assign(sd=[0.0, 0.003])).within_two_sd == 0.75


def test_rows_are_told_by_where_they_lie_not_by_their_labels() -> None:
    """Tables of single stones, one after another, have each label as often."""
    alike = TRUTH.assign(sd=[0.001, 0.0]).set_index(pd.Index([0, 0]))
    assert score_tracks(FOUND, alike) == score_tracks(FOUND, alike.reset_index(drop=True))


def test_places_measured_by_hand_say_how_well(tmp_path: Path) -> None:
    TRUTH.to_csv(tmp_path / "clip.truth.csv", index=False)
    facts = {"e": 0.8, "mu": 0.01, "real_stones": {"B": 0.004}}
    (tmp_path / "clip.truth.json").write_text(json.dumps(facts))
    assert read_truth(tmp_path / "clip.mp4").stones["sd"].tolist() == [
        0.0, pytest.approx(0.004 / 2**0.5),
    ]  # fmt: skip
