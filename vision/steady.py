"""Places of a stone steadied by the lightness of its cap.

Colour is coded half as finely as lightness, and coarsely: the edge of a cap by its hue is aside
by a tenth of a pixel for a second or so, the more the camera moves, and then by another. Its edge
by lightness is not, but lamps from one side draw it aside for as long as they shine there. So
lightness says how a stone goes from picture to picture, and hue, on the mean of some seconds,
where that is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vision.roundness import WHOLE
from vision.sighting import Sighting

Array = NDArray[np.float64]

MEMORY = 3.0
"""Seconds before and after, over which lamps draw the edge by lightness aside alike: what the
edge by hue is aside by has changed several times by then."""

FEWEST = 12
"""Sightings from which the two edges are compared."""

WILD = 4.0
"""Bends of the way, in root mean squares, beyond which they say nothing of the scatter."""


def steadied(times: Sequence[float], seen: Sequence[Sighting]) -> list[Sighting]:
    """Steady the places of one stone, by as much as their scatter says.

    Parameters
    ----------
    times : sequence of float
        Ascending, s.
    seen : sequence of Sighting
        The stone at these times.
    """
    out = list(seen)
    light = np.array([sighting.light for sighting in seen])
    whole = np.array([sighting.visible > WHOLE for sighting in seen])
    told = np.flatnonzero(whole & np.isfinite(light).all(1))
    if len(told) < FEWEST:
        return out
    places = np.array([(seen[i].x, seen[i].y) for i in told.tolist()])
    aside = light[told] - _lasting(np.array(times)[told], light[told])
    share, gain = _share(np.diff(places, 2, axis=0), np.diff(aside, 2, axis=0))
    steady = (places + share * aside).tolist()
    for rank, (x, y) in zip(told.tolist(), steady, strict=True):
        one = out[rank]
        out[rank] = one._replace(x=x, y=y, sd_x=gain * one.sd_x, sd_y=gain * one.sd_y)
    return out


def _lasting(times: Array, values: Array) -> Array:
    """Means of values, (n, 2), over what lies no farther than `MEMORY` from each time."""
    first = np.searchsorted(times, times - MEMORY)
    end = np.searchsorted(times, times + MEMORY, side="right")
    total = np.concatenate([np.zeros((1, 2)), np.cumsum(values, axis=0)])
    return np.asarray((total[end] - total[first]) / (end - first)[:, None])


def _share(places: Array, aside: Array) -> tuple[float, float]:
    """Tell the share of what lightness says at which a way bends least, and by how much less.

    Parameters
    ----------
    places, aside : ndarray, shape (n, 2)
        Second differences of the places, and of what the edge by lightness lies off them, m.
    """
    size = np.hypot(*places.T)
    near = size <= WILD * np.sqrt(np.mean(np.minimum(size, 3 * np.median(size)) ** 2))
    bends, offers = places[near], aside[near]
    power = float((offers**2).sum())
    if not power or not bends.any():
        return 0.0, 1.0
    share = float(np.clip(-(bends * offers).sum() / power, 0.0, 1.0))
    left = ((bends + share * offers) ** 2).sum() / (bends**2).sum()
    return share, float(np.sqrt(left))
