"""Places of a stone steadied by the lightness of its cap.

Colour is coded half as finely as lightness, and coarsely: the edge of a cap by its hue is aside
by a tenth of a pixel for a second or so, the more the camera moves, and then by another. Its edge
by lightness is not, but lamps from one side draw it aside for as long as they shine there. So
lightness says how a stone goes from picture to picture, and hue, on the mean of some seconds,
where that is.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.roundness import WHOLE

Array = NDArray[np.float64]

MEMORY = 3.0
"""Seconds before and after, over which lamps draw the edge by lightness aside alike: what the
edge by hue is aside by has changed several times by then."""

FEWEST = 12
"""Detections from which the two edges are compared."""

SLOWLY = 0.5
"""Time in which hue wanders, s: lightness must steady a way over this as well as from picture to
picture, else what draws it aside changes within a second, and it would lead the stone astray."""

JERK = 5
"""Lags that a track must be long: three make one jerk. Of a track so short that not even half of
`SLOWLY` is left for a lag, it does not tell."""

TINY = 1e-30
"""In place of no power at all, m²."""

WILD = 6.0
"""Jerks of the way beyond which they say nothing of the scatter, in root mean squares of those of
what is aside: a hit shows in the way alone, but over `SLOWLY` in most of its jerks, if not in all.
In 24 drawn clips of 2.6 s shares are 0.15 off (r.m.s.) what errors of the ways have them, with 4.0
0.23, with 10.0 0.22, and 0.50 where what is wild is told by the jerks of the way alone."""


class Lightness(NamedTuple):
    """What the lightness of its cap says of the way of one stone.

    Attributes
    ----------
    told : ndarray of int, shape (n,)
        Detections that it says something of.
    aside : ndarray, shape (n, 2)
        The edge by lightness off their places, beyond what lasts, m.
    jerks : tuple of (float, float, float)
        Power of the jerks of the way, what they have in common with those of what is aside, and
        power of the latter: from picture to picture and, if the way is long enough, over `SLOWLY`.
    """

    told: NDArray[np.int64]
    aside: Array
    jerks: tuple[tuple[float, float, float], ...]


def lightness_of(times: Sequence[float], seen: Iterable[Detection]) -> Lightness:
    """Tell what the lightness of its cap says of the way of a stone.

    Parameters
    ----------
    times : sequence of float
        Ascending, s.
    seen : iterable of Detection
        The stone at these times.
    """
    rows = np.array([(s.x, s.y, *s.light, s.visible) for s in seen]).reshape(-1, 5)
    places, light, visible = rows[:, :2], rows[:, 2:4], rows[:, 4]
    told = np.flatnonzero((visible > WHOLE) & np.isfinite(light).all(1))
    if len(told) < FEWEST:
        return Lightness(told[:0], light[:0], ())
    at = np.array(times)[told]
    aside = light[told] - _lasting(at, light[told])
    slow = SLOWLY / float(np.median(np.diff(at)))
    lag = max(min(round(slow), len(told) // JERK), 1)
    lags = (1, lag) if 2 * lag >= slow else (1,)
    return Lightness(told, aside, tuple(_jerks(at, places[told], aside, each) for each in lags))


def common_share(stones: Iterable[Lightness]) -> float:
    """Share of what lightness says by which the ways of stones with like caps jerk least.

    Lamps and coding treat like caps alike, and one stone alone tells little: shares of single
    stones came out anywhere between a tenth and all.

    Returns
    -------
    float
        0 to 1; 0 where no way is long enough to tell.
    """
    long = np.array([stone.jerks for stone in stones if len(stone.jerks) > 1]).reshape(-1, 2, 3)
    _, common, power = long.sum(0).T
    return float(np.clip(-common / np.maximum(power, TINY), 0.0, 1.0).min())


def steadied(seen: Sequence[Detection], light: Lightness, share: float) -> list[Detection]:
    """Steady the places of one stone by a share of what lightness says.

    Parameters
    ----------
    seen : sequence of Detection
        The stone.
    light : Lightness
        Of it.
    share : float
        See `common_share`. Stated errors become smaller by as much as the way jerks less.
    """
    out = list(seen)
    if not share or not light.jerks:
        return out
    way, common, power = light.jerks[0]
    left = way + share * (2 * common + share * power)
    gain = sqrt(max(left, 0.0) / way) if way else 1.0
    for rank, (u, v) in zip(light.told.tolist(), (share * light.aside).tolist(), strict=True):
        one = out[rank]
        out[rank] = one._replace(
            x=one.x + u, y=one.y + v, sd_x=gain * one.sd_x, sd_y=gain * one.sd_y
        )
    return out


def _lasting(times: Array, values: Array) -> Array:
    """Means of values, (n, 2), over what lies no farther than `MEMORY` from each time."""
    first = np.searchsorted(times, times - MEMORY)
    end = np.searchsorted(times, times + MEMORY, side="right")
    total = np.concatenate([np.zeros((1, 2)), np.cumsum(values, axis=0)])
    return np.asarray((total[end] - total[first]) / (end - first)[:, None])


def _jerks(times: Array, places: Array, aside: Array, lag: int) -> tuple[float, float, float]:
    """Powers of third divided differences at a lag, of a unit weight each, but for those of hits.

    A glide does not show in them, be the times even or not.
    """
    four = np.arange(len(times) - 3 * lag)[:, None] + lag * np.arange(4)
    apart = times[four][:, :, None] - times[four][:, None] + np.eye(4)
    weight = 1 / apart.prod(axis=2)
    weight /= np.linalg.norm(weight, axis=1)[:, None]
    way, offer = (np.einsum("nk,nkc->nc", weight, z[four]) for z in (places, aside))
    near = (way**2).sum(1) <= WILD**2 * (offer**2).sum(1).mean()
    way, offer = way[near], offer[near]
    return float((way**2).sum()), float((way * offer).sum()), float((offer**2).sum())
