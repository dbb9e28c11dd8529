"""What tests of free glides share."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.data.tracks import check_detections
from curlshot.physics.local_fit.local import Local, estimate_locally
from curlshot.tests.helpers.physics.watch import RADIUS, Floats

FPS = 60


def seen(*ways: Floats, sd: float = 0.001) -> pd.DataFrame:
    """Detections of ways, (n, 2) at `FPS`, of as many stones."""
    tables = []
    for k, way in enumerate(ways):
        x, y = (way + np.random.default_rng(k).normal(0, sd, way.shape)).T
        tables.append(
            pd.DataFrame({"stone": f"S{k}", "t": np.arange(len(way)) / FPS, "x": x, "y": y})
        )
    return check_detections(pd.concat(tables))


def told(*ways: Floats) -> Local:
    return estimate_locally(seen(*ways), (), radius=RADIUS)
