"""Whether a house after a cut is what was seen long before it: a replay, not the shot going on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.picture import Picture, lightness_at
from vision.pose import View, project

Array = NDArray[np.float64]

CELLS, FINER = 48, 2
"""Cells of a glimpse along each side, and samples of which each is the mean."""

EVERY = 0.2
"""Time from one glimpse to the next, s: people move a hand's breadth."""

LONG_BEFORE = 0.8
"""What was seen so long before the cut is not the shot going on, s."""

ALIKE = 0.5
"""A replay differs so much less from what was long before than from what was last."""

_COURSE = np.linspace(-HOUSE.twelve_foot, HOUSE.twelve_foot, CELLS * FINER)
_PLACES = np.stack(np.meshgrid(_COURSE, _COURSE), axis=-1).reshape(-1, 2)


@dataclass(frozen=True)
class Glimpse:
    """The house from above, coarsely, at one time.

    Attributes
    ----------
    t : float
        S.
    grey : ndarray, shape (48, 48)
        Lightness; NaN where the picture ends.
    """

    t: float
    grey: Array


def glimpse(picture: Picture, view: View, rig: Array, t: float) -> Glimpse:
    """Look at the house from above."""
    h, w = picture.shape[:2]
    x, y = project(_PLACES, view.vector, rig, (w, h)).T
    with np.errstate(invalid="ignore"):
        seen = (x > 0) & (y > 0) & (x < w - 1) & (y < h - 1)
    side = (CELLS * FINER, CELLS * FINER)
    across, down = (np.where(seen, v, -9.0).astype(np.float32).reshape(side) for v in (x, y))
    grey = lightness_at(picture, across, down).astype(np.float64)
    grey[~seen.reshape(side)] = np.nan
    return Glimpse(t, np.asarray(cv2.resize(grey, (CELLS, CELLS), interpolation=cv2.INTER_AREA)))


def is_replay(now: Glimpse, before: Sequence[Glimpse]) -> bool:
    """Say whether a glimpse repeats one from long before the last one."""
    older = [g for g in before if g.t < before[-1].t - LONG_BEFORE]
    return bool(older) and is_nearer(now, older, before[-1], ALIKE)


def is_nearer(now: Glimpse, these: Sequence[Glimpse], that: Glimpse, share: float = 0.8) -> bool:
    """Say whether a glimpse differs from one of these by less than this share of from that."""
    nearest = min((_difference(now, g) for g in these), default=np.inf)
    return nearest < share * _difference(now, that)


def _difference(one: Glimpse, other: Glimpse) -> float:
    """Mean difference of what both show; infinite if that is less than a third of the house."""
    away = np.abs(one.grey - other.grey)
    known = np.isfinite(away)
    return float(away[known].mean()) if known.mean() > 1 / 3 else float("inf")
