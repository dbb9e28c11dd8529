from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from data.tracks import SIGHTING_COLUMNS
from work.analyse import analyse
from work.measure import Measured
from work.settings import Settings


def test_samples_that_cannot_be_drawn_are_not_left_out_in_silence() -> None:
    still = pd.DataFrame({"stone": "A", "frame": range(20), "t": np.arange(20) / 25})
    still = still.assign(x=0.1, y=0.2, team="", sd_x=0.003, sd_y=0.003, sd_place=0.0)
    still = still.reindex(columns=list(SIGHTING_COLUMNS))
    seen = Measured((Path("still.csv"),), still, 25.0, 20, ())
    done = analyse(seen, Settings(samples=10))
    assert done.posterior is None
    assert any("no samples" in text for text in done.results.warnings)
    assert not any("no samples" in text for text in analyse(seen).results.warnings)
