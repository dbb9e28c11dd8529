"""Replays: whether a house after a cut is what was seen long before it, not the shot going on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.pose import View, project
from curlshot.vision.video.disk_cache import Cached
from curlshot.vision.video.picture import Picture, lightness_at

Array = NDArray[np.float64]
Halves = NDArray[np.float16]

CELLS, FINER = 48, 2
"""Cells of a glimpse along each side, and samples of which each is the mean."""

EVERY = 0.2
"""Time from one glimpse to the next, s: people move a hand's breadth."""

LONG_BEFORE = 0.8
"""What was seen so long before the cut is not the shot going on, s."""

ALIKE = 0.5
"""A replay differs so much less from what was long before than from what was last."""

CHANGED, LEAST_CELLS, PLACES, NEW_PLACES = 25.0, 4, 3, 2
"""Grey levels by which a cell looks otherwise, cells that make a place of change, how many places
must change between two glimpses if they belong to different shots, and how many must then show
again what is not usual there, nor bare ice: people who go only uncover what was there before."""

SUDDEN = 0.7
"""Share of a change that comes with one picture if there is a cut before it."""

_COURSE = np.linspace(-HOUSE.twelve_foot, HOUSE.twelve_foot, CELLS * FINER)
_PLACES = np.stack(np.meshgrid(_COURSE, _COURSE), axis=-1).reshape(-1, 2)

_RING = np.hypot(*(np.indices((CELLS, CELLS)) - (CELLS - 1) / 2)).round().astype(int)
"""How far each cell is from the tee, in cells."""


@dataclass(frozen=True)
class Glimpse:
    """The house from above, coarsely, at one time.

    Attributes
    ----------
    t : float
        When, s.
    kept : Cached of ndarray
        See `grey`; all of a clip are kept.
    """

    t: float
    kept: Cached[Halves]

    @property
    def grey(self) -> Halves:
        """Lightness, to .06, shape (48, 48); NaN where the picture ends."""
        return self.kept.get()


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
    small = cv2.resize(grey, (CELLS, CELLS), interpolation=cv2.INTER_AREA)
    return Glimpse(t, Cached(np.asarray(small, np.float16)))


def is_replay(now: Glimpse, before: Sequence[Glimpse]) -> bool:
    """Say whether a glimpse repeats one from long before the last one that shows the same ice."""
    known = [g for g in before if np.isfinite(_difference(now, g))]
    older = [g for g in known if g.t < known[-1].t - LONG_BEFORE]
    return bool(older) and is_nearer(now, older, known[-1], ALIKE)


def has_jumped(now: Glimpse, last: Glimpse) -> bool:
    """Say whether several things are elsewhere than they were a glimpse before."""
    return _places(_differ(now.grey, last.grey)) >= PLACES


def shows_again(now: Glimpse, before: Sequence[Glimpse], like: Sequence[Glimpse]) -> bool:
    """Say whether things are again where they were once, not a glimpse before nor usually.

    Parameters
    ----------
    now : Glimpse
    before : sequence of Glimpse
        What was seen before a cut, if there was one, up to the last.
    like : sequence of Glimpse
        What may be seen again.
    """
    usual = np.median([look.grey for look in before], axis=0)
    new = _differ(now.grey, before[-1].grey) & _differ(now.grey, usual) & _things(now.grey)
    nearest = min(like, key=lambda look: _difference(now, look))
    again = new & ~_differ(now.grey, nearest.grey)
    return _places(new) >= NEW_PLACES and bool(again.sum() > 0.5 * new.sum())


def _away(one: Halves, other: Halves) -> NDArray[np.float32]:
    return np.abs(np.subtract(one, other, dtype=np.float32))


def _differ(one: Halves, other: Halves) -> NDArray[np.bool_]:
    return np.asarray(_away(one, other) > CHANGED)


def _things(grey: Halves) -> NDArray[np.bool_]:
    """Cells that look otherwise than most as far from the tee, but for thin lines."""
    bare = np.full(grey.shape, np.nan)
    for ring in range(int(_RING.max()) + 1):
        there = ring == _RING
        seen = grey[there][np.isfinite(grey[there])]
        bare[there] = np.median(seen) if len(seen) else np.nan
    things, square = _differ(grey, np.asarray(bare, np.float16)), np.ones((2, 2), np.uint8)
    # Not `cv2.MORPH_OPEN`: by a square of even size it shifts what is left by a cell.
    left = cv2.erode(things.astype(np.uint8), square, anchor=(0, 0),
                     borderType=cv2.BORDER_CONSTANT, borderValue=0)  # fmt: skip
    return np.asarray(cv2.dilate(left, square, anchor=(1, 1)) > 0)


def _places(cells: NDArray[np.bool_]) -> int:
    """Count the connected places that some of the cells make up."""
    count, _, stats, _ = cv2.connectedComponentsWithStats(cells.astype(np.uint8))
    return int((stats[1:count, cv2.CC_STAT_AREA] >= LEAST_CELLS).sum())


def cut_among(looks: Sequence[Glimpse]) -> int | None:
    """Tell from which of some glimpses on, one after the other, another shot is seen; or None.

    A cut changes all at once; what moves changes step by step.
    """
    steps = [_difference(one, other) for one, other in pairwise(looks)]
    largest = max(range(len(steps)), key=steps.__getitem__)
    sudden = steps[largest] > SUDDEN * _difference(looks[0], looks[-1])
    return largest + 1 if sudden else None


def is_nearer(now: Glimpse, these: Sequence[Glimpse], that: Glimpse, share: float = 0.8) -> bool:
    """Say whether a glimpse differs from one of these by less than this share of from that.

    What does not show the same ice is not compared.
    """
    nearest, last = (
        min((_difference(now, g) for g in these), default=np.inf),
        _difference(now, that),
    )
    return bool(np.isfinite(last) and nearest < share * last)


def _difference(one: Glimpse, other: Glimpse) -> float:
    """Mean difference of what both show; infinite if that is less than a third of the house."""
    away = _away(one.grey, other.grey)
    known = np.isfinite(away)
    return float(away[known].mean()) if known.mean() > 1 / 3 else float("inf")
