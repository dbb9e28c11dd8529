"""Where a camera is of which a sliver of the house tells little: where the sides are straight.

Of a few degrees of a circle a lens, a lean and a height make nearly the same. Sides that run for
metres beside it are straight lines, and parallel ones, for one lean alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.adjust import Solution, solve
from curlshot.vision.optics.paint import Marks
from curlshot.vision.optics.pose import View, camera, turned
from curlshot.vision.optics.resection import ROUND
from curlshot.vision.optics.rig import ANYWHERE, POSITION
from curlshot.vision.sheet.lines import SURE_STEP, lesser_side_step, upright
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

ASIDE = np.arange(0.0, 14.1, 0.4)
"""How far from where it is thought to be, towards the middle of the picture or away from it, a
camera is tried, m, as far as the circles allow."""

FINER = 0.1 * np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
"""The same about the best of these: sides are made out a quarter of a metre either way or more."""

NEARLY = 0.8
"""Share of the most that is seen of the sides that is about as much."""

HELD = 0.02
"""How nearly it is held there, m."""

LEAST = SURE_STEP / 2
"""Step at either side of the sheet that is proof of it, grey levels."""


def by_sides(image: Image, circles: Marks, fit: Solution, most: float) -> tuple[View, Array] | None:
    """Fit a camera to what is seen of circles so that both sides of the sheet are straight.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    circles : Marks
        Of the house in it.
    fit : Solution
        To begin with: the best fit of these.
    most : float
        By how much more than that fit one may cost.

    Returns
    -------
    (View, ndarray) or None
        View and rig; None where there are no such sides from anywhere.
    """
    size = (image.shape[1], image.shape[0])
    marks, start, shared = _to_the_middle(circles, fit.views[0], fit.rig, size)

    def tried(view: View, rig: Array, places: Array) -> Iterator[_Tried]:
        for place in places:
            held = _held(marks, view, rig, size, float(place))
            view, rig = held.views[0], held.rig
            if held.cost > fit.cost + most:
                break
            up = upright(image, view, rig)
            seen = lesser_side_step(image, *up)
            yield _Tried(seen, held.cost, float(place), (view, rig), up)

    here = shared[POSITION][1]
    roughly = [*tried(start, shared, here + ASIDE), *tried(start, shared, here - ASIDE[1:])]
    most_seen = max((one.step for one in roughly), default=0.0)
    if not most_seen:
        return None
    # Of places from which sides are seen about as well, the circles tell which it is.
    likely = [one for one in roughly if one.step >= NEARLY * most_seen]
    best = min(likely, key=lambda one: one.cost)
    near = [best, *tried(*best.held, best.place + FINER)]
    best = max(near, key=lambda one: one.step)
    return best.upright if best.step > LEAST else None


@dataclass(frozen=True)
class _Tried:
    """A camera held at a place, what it costs, and with the ice's axes upright its sides' step."""

    step: float
    cost: float
    place: float
    held: tuple[View, Array]
    upright: tuple[View, Array]


def _to_the_middle(
    circles: Marks, view: View, rig: Array, size: tuple[int, int]
) -> tuple[Marks, View, Array]:
    """Turn the ice's axes so that y points from the tee to the middle of the picture.

    That way a sliver of the house leaves open where the camera is.
    """
    x, y = camera(view, rig, size).ice(np.array([[size[0] / 2, size[1] / 2]]))[0]
    turn = float(np.arctan2(y, x)) - np.pi / 2
    return replace(circles, along=circles.along - turn), *turned(view, rig, turn)


def _held(circles: Marks, view: View, rig: Array, size: tuple[int, int], place: float) -> Solution:
    """Fit a camera that is so far from the tee along y, m."""
    mean, sd = ANYWHERE.mean.copy(), ANYWHERE.sd.copy()
    mean[POSITION][1], sd[POSITION][1] = place, HELD
    prior = replace(ANYWHERE, mean=mean, sd=sd)
    return solve([circles], [view], rig, size, prior=prior, view_sd=ROUND)
