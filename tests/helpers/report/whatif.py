"""What tests of whatif share."""

from __future__ import annotations

import numpy as np
import pandas as pd


def outcomes(centre: tuple[float, float], count: int = 300) -> pd.DataFrame:
    rng = np.random.default_rng(0)
    a = pd.DataFrame(rng.normal(centre, 0.2, (count, 2)), columns=["x", "y"]).assign(stone="A")
    b = pd.DataFrame({"x": 0.5, "y": 0.5, "stone": "B"}, index=range(count))
    c = pd.DataFrame({"x": rng.normal(0, 9, count), "y": 1.0, "stone": "$C"})
    a, b, c = (
        table.assign(sample=np.arange(count), hits=hits) for table, hits in ((a, 1), (b, 0), (c, 1))
    )
    return pd.concat([a, b, c], ignore_index=True).assign(in_play=1)
