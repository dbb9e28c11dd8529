"""What tests of export share."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.data.tracks import check_detections


def shot(seed: int = 0, stones: str = "ABC", even: bool = True) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    frame = np.arange(12, 52)
    t = frame / 30 if even else np.cumsum(rng.uniform(0.02, 0.06, len(frame)))
    rows = [
        pd.DataFrame(
            {
                "stone": stone,
                "frame": frame,
                "t": t,
                "x": np.sin(t) + rng.normal(0, 0.001, len(t)),
                "y": 2 * t,
                # The air moves pucks that turn six times a second.
                "theta": 31.0 + (40 * t if stone == "C" else t) if stone != "B" else np.nan,
                "sd_x": 0.002 if stone != "C" else np.nan,
                "sd_y": 0.003 if stone != "C" else np.nan,
                "sd_theta": 0.02 if stone == "A" else np.nan,
            }
        )[rng.uniform(size=len(t)) > 0.2]
        for stone in stones
    ]
    return check_detections(pd.concat(rows))


SAME = ["stone", "frame", "t", "x", "y", "theta", "sd_x", "sd_y", "sd_theta"]
