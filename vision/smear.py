"""How long pictures are exposed, told by how far a pan smears the edges in them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

USUAL = 0.5
"""Share of the time from one frame to the next for which film is exposed as a rule."""

LEAST, MOST = 0.1, 1.0
"""Shortest exposure that is told from none, and the longest there can be."""

SHARP = 2.5
"""Width of an edge in a picture in which nothing moves, px."""

LEAST_MOTION, LEAST_EDGES = 12.0, 6
"""How far an edge must move along its normal from frame to frame to tell, px; and how many."""


def exposure(slope: Array, motion: Array) -> float | None:
    """Tell the share of the time from one frame to the next for which pictures are exposed.

    Parameters
    ----------
    slope : ndarray, shape (n,)
        Slopes of edges half way up, in steps from the one side to the other, per px; NaN where
        not known.
    motion : ndarray, shape (n,)
        How far each moves along its normal from frame to frame, px.

    Returns
    -------
    float or None
        None where too few of them move.
    """
    told = np.isfinite(slope) & (slope > 0) & (np.abs(motion) > LEAST_MOTION)
    if told.sum() < LEAST_EDGES:
        return None
    width = np.sqrt(np.maximum(slope[told] ** -2.0 - SHARP**2, 0.0))
    return float(np.clip(np.median(width / np.abs(motion[told])), LEAST, MOST))
