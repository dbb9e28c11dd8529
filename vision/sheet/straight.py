"""Where a camera is of which a sliver of the house tells little: where the sides are straight.

Of a few degrees of a circle a lens, a lean and a height make nearly the same. Sides that run for
metres beside it are straight lines, and parallel ones, for one lean alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vision.film.picture import Image
from vision.optics.adjust import Solution, solve
from vision.optics.paint import Marks
from vision.optics.pose import View
from vision.optics.rig import ANYWHERE, POSITION
from vision.sheet.lines import SURE_STEP, lesser_side_step, upright

Array = NDArray[np.float64]

PLACES = np.arange(0.0, 7.1, 0.4)
"""How far up or down the sheet a camera is tried, m: sides are made out half a metre either way."""

HELD = 0.02
"""How nearly it is held there, m."""


def by_sides(
    image: Image, circles: Marks, fit: Solution, *, sharing: float, most: float, view_sd: ArrayLike
) -> tuple[View, Array] | None:
    """Fit a camera to what is seen of circles so that both sides of the sheet are straight.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    circles : Marks
        Of the house in it.
    fit : Solution
        To begin with: the best fit of these.
    sharing : float
        As for `vision.optics.adjust.solve`.
    most : float
        By how much more than that fit one may cost.
    view_sd : array_like, shape (4,)
        As for `vision.optics.adjust.solve`.

    Returns
    -------
    (View, ndarray) or None
        View and rig; None where there are no such sides from anywhere.
    """
    size = (image.shape[1], image.shape[0])
    best, step = None, SURE_STEP / 2
    for way in (1.0, -1.0):
        view, rig = fit.views[0], fit.rig
        for y in way * PLACES:
            tried = _held(circles, view, rig, size, float(y), sharing, view_sd)
            view, rig = tried.views[0], tried.rig
            if tried.cost > fit.cost + most:
                continue
            up = upright(image, view, rig)
            seen = lesser_side_step(image, *up)
            if seen > step:
                best, step = up, seen
    return best


def _held(
    circles: Marks,
    view: View,
    rig: Array,
    size: tuple[int, int],
    y: float,
    sharing: float,
    view_sd: ArrayLike,
) -> Solution:
    """Fit a camera that is so far up the sheet, m."""
    mean, sd = ANYWHERE.mean.copy(), ANYWHERE.sd.copy()
    mean[POSITION][1], sd[POSITION][1] = y, HELD
    prior = replace(ANYWHERE, mean=mean, sd=sd)
    return solve([circles], [view], rig, size, prior=prior, sharing=sharing, view_sd=view_sd)
