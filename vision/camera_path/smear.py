"""Motion blur of edges in a pan: its width, the exposure time it tells, the reach of normals."""

from __future__ import annotations

from dataclasses import dataclass

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

REACH, LEAST_REACH = 0.007, 6.0
"""Half length of the normals in widths of the picture, and the least, px."""

LONGER, MOST_REACH = 1.2, 0.04
"""Half length of the normals in what a pan blurs edges by; and the most, widths of the picture."""

LEARNING = 0.5
"""Share that one more picture counts: a pan is soon over, and a second tells most of it."""

MOST_SMEARED = 0.9
"""Share of the edges that are smeared by less than what is said of a picture: edges along a pan
stay sharp, some are print."""


@dataclass
class Shutter:
    """What is known of how long pictures are exposed.

    Attributes
    ----------
    exposure : float
        Share of the time from one picture to the next.
    """

    exposure: float = USUAL

    def learn(self, slope: Array, motion: Array) -> None:
        """Take in what one more picture tells, if it does; see `exposure`."""
        told = exposure(slope, motion)
        if told is not None:
            self.exposure += LEARNING * (told - self.exposure)


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
    return float(np.clip(np.median(_width(slope[told]) / np.abs(motion[told])), LEAST, MOST))


def smear(slope: Array) -> float:
    """Tell how far the edges of a picture are smeared, px, by their slopes as for `exposure`."""
    told = np.sort(slope[slope > 0])
    if len(told) < LEAST_EDGES:
        return 0.0
    return float(_width(told[round((1 - MOST_SMEARED) * (len(told) - 1))]))


def reach_beyond(blur: float, width: int) -> float:
    """Half length of normals of which the outer quarters show what is beside a blur, px.

    Parameters
    ----------
    blur : float
        px.
    width : int
        Of the picture, px.
    """
    least = max(REACH * width, LEAST_REACH)
    return min(max(LONGER * blur, least), max(MOST_REACH * width, least))


def _width(slope: Array | float) -> Array:
    """Width of edges beyond that of sharp ones, px."""
    return np.asarray(np.sqrt(np.maximum(slope**-2.0 - SHARP**2, 0.0)))
