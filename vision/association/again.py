"""Stones measured again whose motion was not known when they were looked at."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.association.expected import look_on_course
from curlshot.vision.association.follower import StoneView
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.smeared import swept_share
from curlshot.vision.detection.stones import Search

Array = NDArray[np.float64]

MOST_STEP = 1.4
"""Up to how far, in radii, a stone goes from one picture to the next: nearer there is no other."""


def measure_again(
    views: Sequence[StoneView], appearance: Appearance | None, disc: Stone, search: Search
) -> None:
    """Measure stones again that were so fast that their caps are smeared, if that was not known.

    A stone that comes into view or is hit is found where it is, not where it was expected.

    Parameters
    ----------
    views : sequence of StoneView
        Pictures in a row; detections in them are replaced.
    appearance : Appearance or None
        What stones look like here.
    disc : Stone
    search : Search
        What they must show.
    """
    places = [view.places for view in views]
    doubtful: list[tuple[StoneView, int]] = []
    looks = []
    for k, view in enumerate(views):
        before, after = (
            places[j] if 0 <= j < len(views) else places[k][:0] for j in (k - 1, k + 1)
        )
        drift = drifts(places[k], before, after, MOST_STEP * disc.radius)
        smeared = swept_share(view.drift_seen(places[k], drift)) > 0
        fast = [i for i in np.flatnonzero(smeared).tolist() if not view.detections[i].swept]
        if fast:
            doubtful += [(view, i) for i in fast]
            looks.append(view.look(places[k][fast].tolist(), drift[fast].tolist()))
    if not looks:
        return
    seen = look_on_course(looks, appearance, disc, search)
    for (view, i), found in zip(doubtful, seen, strict=True):
        if found is not None and found.swept:
            view.detections[i] = found.without_samples()


def drifts(places: Array, before: Array, after: Array, reach: float) -> Array:
    """Tell how far stones move from one picture to the next, (n, 2), m; 0 where it is not seen.

    Parameters
    ----------
    places, before, after : ndarray, shapes (n, 2), (m, 2) and (k, 2)
        Of the stones in a picture, in that before and in that after it, m.
    reach : float
        How far a stone may be from one to the next, m.
    """
    out = np.zeros((len(places), 2))
    for there, sign in ((before, -1.0), (after, 1.0)):
        if len(there) and len(places):
            way = there[None] - places[:, None]
            nearest = np.hypot(way[..., 0], way[..., 1]).argmin(1)
            step = sign * way[np.arange(len(places)), nearest]
            near = np.hypot(*step.T) < reach
            out[near] = step[near]
    return out
