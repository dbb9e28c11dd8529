"""What tests of segments share."""

from __future__ import annotations

import numpy as np

from curlshot.physics.local_fit.traces import Trace


def trace(t: np.ndarray, y: np.ndarray, sd: float, seed: int = 0) -> Trace:
    rng = np.random.default_rng(seed)
    xy = np.column_stack([np.zeros_like(y), y]) + rng.normal(0, sd, (len(t), 2))
    nothing = np.full(len(t), np.nan)
    return Trace("A", t, xy, np.full((len(t), 2), sd), nothing, nothing, 0 * xy, 0 * xy)
