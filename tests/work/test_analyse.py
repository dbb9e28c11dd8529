from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from data.sheet import HOUSE
from data.tracks import SIGHTING_COLUMNS
from work.analyse import analyse
from work.measure import Measured
from work.settings import Settings


def test_samples_that_cannot_be_drawn_are_not_left_out_in_silence() -> None:
    still = pd.DataFrame({"stone": "A", "frame": range(20), "t": np.arange(20) / 25})
    still = still.assign(
        x=0.1, y=0.2, team="", sd_x=0.003, sd_y=0.003, sd_place_x=0.0, sd_place_y=0.0
    )
    still = still.reindex(columns=list(SIGHTING_COLUMNS))
    seen = Measured((Path("still.csv"),), still, 25.0, 20, ())
    done = analyse(seen, Settings(samples=10))
    assert done.posterior is None
    assert any("no samples" in text for text in done.results.warnings)
    assert not any("no samples" in text for text in analyse(seen).results.warnings)


@pytest.mark.parametrize(
    ("slower", "said"), [(1.0, ""), (4.0, "slow motion"), (0.4, "fast motion")]
)
def test_a_clip_in_slow_motion_is_told_by_its_friction(slower: float, said: str) -> None:
    t = np.arange(50) / 25
    y = 2.0 - 1.2 * (t / slower) + 0.5 * 0.0109 * 9.81 * (t / slower) ** 2
    noise = np.random.default_rng(0).normal(0, 0.0003, (2, 50))
    glide = pd.DataFrame({"stone": "A", "frame": range(50), "t": t, "x": noise[0]})
    glide = glide.assign(
        y=y + noise[1], team="", sd_x=0.0003, sd_y=0.0003, sd_place_x=0.0, sd_place_y=0.0
    )
    glide = glide.reindex(columns=list(SIGHTING_COLUMNS))
    seen = Measured((Path("glide.csv"),), glide, 25.0, 50, (), house=HOUSE)
    warnings = [w for w in analyse(seen).results.warnings if "motion" in w]
    assert [said in w for w in warnings] == [True] * bool(said)
