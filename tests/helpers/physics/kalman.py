"""Errors of filtered tracks against the true motion."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.synthetic.physics import Motion

COLUMNS = ("x", "y", "theta", "vx", "vy", "omega")


def errors(tracks: pd.DataFrame, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Errors of a table of tracks and their stated standard deviations, COLUMNS each."""
    truth = motion.at(tracks["t"].to_numpy())
    index = tracks["stone"].map({"A": 0, "B": 1}).to_numpy()
    exact = truth[np.arange(len(tracks)), index]
    off = tracks[list(COLUMNS)].to_numpy() - exact
    return off, tracks[[f"sd_{name}" for name in COLUMNS]].to_numpy()
