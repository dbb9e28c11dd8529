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

from vision.detection.roundness import WHOLE
from vision.detection.sighting import Sighting

Array = NDArray[np.float64]

MEMORY = 3.0
"""Seconds before and after, over which lamps draw the edge by lightness aside alike: what the
edge by hue is aside by has changed several times by then."""

FEWEST = 12
"""Sightings from which the two edges are compared."""

SLOWLY = 0.5
"""Time in which hue wanders, s: lightness must steady a way over this as well as from picture to
picture, else what draws it aside changes within a second, and it would lead the stone astray."""

JERK = 5
"""Lags that a track must be long: three make one jerk. Of a track so short that not even half of
`SLOWLY` is left for a lag, it is not known, and lightness has no say."""

WILD = 4.0
"""Jerks of the way, in root mean squares, beyond which they say nothing of the scatter: hits."""


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
    at, places = np.array(times)[told], np.array([(seen[i].x, seen[i].y) for i in told.tolist()])
    aside = light[told] - _lasting(at, light[told])
    share, gain = _share(at, places, aside)
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


def _share(times: Array, places: Array, aside: Array) -> tuple[float, float]:
    """Tell by what share of what lightness says a way is steadied, and what is left of its scatter.

    Parameters
    ----------
    times : ndarray, shape (n,)
    places, aside : ndarray, shape (n, 2)
        The places, and what the edge by lightness lies off them beyond what lasts, m.
    """
    slow = SLOWLY / float(np.median(np.diff(times)))
    lag = max(min(round(slow), len(times) // JERK), 1)
    if 2 * lag < slow:
        return 0.0, 1.0
    jerks = [_jerks(times, places, aside, each) for each in (1, lag)]
    share = min(_steadiest(*each) for each in jerks)
    if not share:
        return 0.0, 1.0
    way, offer = jerks[0]
    return share, float(np.sqrt(((way + share * offer) ** 2).sum() / (way**2).sum()))


def _jerks(times: Array, places: Array, aside: Array, lag: int) -> tuple[Array, Array]:
    """Third divided differences at a lag, of a unit weight each, but for those of hits.

    A glide does not show in them, be the times even or not.
    """
    four = np.arange(len(times) - 3 * lag)[:, None] + lag * np.arange(4)
    apart = times[four][:, :, None] - times[four][:, None] + np.eye(4)
    weight = 1 / apart.prod(axis=2)
    weight /= np.linalg.norm(weight, axis=1)[:, None]
    way, offer = (np.einsum("nk,nkc->nc", weight, z[four]) for z in (places, aside))
    size = np.hypot(*way.T)
    near = size <= WILD * np.sqrt(np.mean(np.minimum(size, 3 * np.median(size)) ** 2))
    return way[near], offer[near]


def _steadiest(way: Array, offer: Array) -> float:
    """Share of what is offered at which a way jerks least, 0 to 1."""
    power = float((offer**2).sum())
    return float(np.clip(-(way * offer).sum() / power, 0.0, 1.0)) if power else 0.0
