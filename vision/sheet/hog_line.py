"""A lens told by the hog line: circles alone hardly tell how much a wide one bends.

Cameras of clubs have wide lenses, and show a sheet from behind the house to the hog line. Of the
circles a lens that bends less, a higher camera and another tilt make nearly the same, and guards
come to lie metres from where they are. One of these lenses has a straight line across the ice where
the rules have the hog line, and be it at the other end: where stones come up the picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import SHEET
from curlshot.vision.optics.adjust import SHARING, Solution, solve
from curlshot.vision.optics.lean import fit_leaning
from curlshot.vision.optics.paint import HOG_LINE, Marks, joined
from curlshot.vision.optics.pose import View, pictured, project
from curlshot.vision.optics.resection import ROUND
from curlshot.vision.optics.rig import BACK_Y, BENT, HOG_Y, K1, WIDE, Prior, with_lens
from curlshot.vision.sheet.lines import back_end, upright
from curlshot.vision.sheet.marks import EDGE_SD
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

LENSES = np.arange(-0.40, 0.11, 0.02)
"""k1 of the lenses tried; k2 goes with it (`curlshot.vision.optics.rig`)."""

MIDDLE = SHEET.hog_line + 0.05
"""Where the middle of the line is, m: the rules have its inner edge, and 10 cm for its width."""

ABOUT = np.arange(-0.30, 0.301, 0.015)
"""How far from there it is looked for, m."""

NEAR = 0.15
"""How far from there it may be with the lens that is nearest, m: half of what one step moves it."""

ACROSS = np.arange(-2.0, 2.01, 0.05)
"""Where it is looked at, m."""

IN_VIEW = 4.8
"""How far the ice must seem to be seen for the line to be in view, m: with a lens that is told by
circles alone, what is at 6.4 m may seem to be a metre and more aside."""

ENOUGH = int(0.4 * len(ACROSS))
"""How many of these must show it."""

EACH = 5
"""Of these are looked at together where its edge is measured."""

ON, BESIDE = 2, 7
"""Steps of `ABOUT` on the line, about its middle, and how far aside the ice beside it is."""

LEAST_CONTRAST, MOST_UNLIKE = 12.0, 0.5
"""Grey levels by which it differs from the ice on either side, and how much these may differ from
each other, as a share of that: boards and borders have ice on one side."""

LIKE, MOST_BARE = 0.35, 0.14
"""How much of its contrast bare ice differs at most from the ice beside it, and at what share of
the places such ice may be where the line is: letters in a row across the sheet have ice between
them (at 16 to 32 %), people on a line are no ice (real lines had it at 11 % at most)."""

MOST_COST = 4.0
"""By how much more than the best lens one may cost, in the circles' log likelihood."""


@dataclass(frozen=True)
class Told:
    """A camera whose lens the hog line tells.

    Attributes
    ----------
    view, rig : View, ndarray
    prior : Prior
        What is known of it beforehand.
    """

    view: View
    rig: Array
    prior: Prior


@dataclass(frozen=True)
class _Tried:
    """A lens, the camera that fits circles best with it, and the line seen with it."""

    k1: float
    fit: Solution
    contrast: float
    off: float
    down: bool


def may_be_in_view(view: View, rig: Array, size: tuple[int, int]) -> bool:
    """Tell whether a camera may show the line, at either end."""
    ends = np.stack(np.broadcast_arrays(ACROSS[:, None], [-IN_VIEW, IN_VIEW]), axis=-1)
    return bool(pictured(ends, view.vector, rig, size)[1].sum(0).max() >= ENOUGH)


def by_hog_line(image: Image, circles: Marks, view: View, rig: Array, prior: Prior) -> Told | None:
    """Fit a camera to circles so that the hog line lies where it is on every sheet.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    circles : Marks
        Of the house in it.
    view, rig : View, ndarray
        A camera that explains them; the ice's axes are upright.
    prior : Prior
        What is known of it beforehand, if its lens is none of the wide ones.

    Returns
    -------
    Told or None
        None where no lens has a line there.
    """
    size = (image.shape[1], image.shape[0])
    free = solve([circles], [view], rig, size, prior=WIDE, view_sd=ROUND)
    if free.cost > MOST_COST * SHARING:
        # What no usual lens explains may have come to rest leaning the other way.
        free = fit_leaning([circles], [view], rig, size, prior=WIDE, view_sd=ROUND)
        view, rig = upright(image, free.views[0], free.rig)
    back = back_end(image, view, rig)
    downs = [down for down in (False, True) if back != (-1 if down else 1)]
    fits = list(_family(image, circles, view, rig, downs))
    most = min(one.fit.cost for one in fits) + MOST_COST * SHARING
    seen = [one for one in fits if one.fit.cost < most and abs(one.off) < NEAR]
    clear = max((one.contrast for one in seen), default=0.0)
    if clear < LEAST_CONTRAST:
        return None
    seen = [one for one in seen if one.contrast > clear / 2]
    # Seen from aside the line is at about the same place with any lens: it tells of none.
    usual = [one for one in seen if one.k1 >= BENT]
    best = min(usual or seen, key=lambda one: abs(one.off))
    known = prior if usual else WIDE
    known = known.downwards() if best.down else known
    rig = best.fit.rig.copy()
    rig[[BACK_Y, HOG_Y]] = known.mean[[BACK_Y, HOG_Y]]
    marks = joined([circles, _edge(image, best)])
    fit = solve([marks], list(best.fit.views), rig, size, prior=known, view_sd=ROUND)
    return Told(fit.views[0], fit.rig, known)


def _family(
    image: Image, circles: Marks, view: View, rig: Array, downs: Sequence[bool]
) -> Iterator[_Tried]:
    """Fit cameras with one lens after another, from that of the rig to both sides.

    As far as they may be: the farther from the best, the more a lens costs. A line is looked for
    towards −y, y, or both.
    """
    size = (image.shape[1], image.shape[0])
    middle, least = int(np.abs(LENSES - rig[K1]).argmin()), np.inf
    for some in (LENSES[middle:], LENSES[:middle][::-1]):
        now, shared = view, rig
        for k1 in some.tolist():
            prior = with_lens(WIDE, k1)
            fit = solve([circles], [now], shared, size, prior=prior, view_sd=ROUND)
            least = min(least, fit.cost)
            if fit.cost > least + MOST_COST * SHARING:
                break
            now, shared = fit.views[0], fit.rig
            for down in downs:
                yield _Tried(k1, fit, *_line_at(image, now, shared, down), down)


def _line_at(image: Image, view: View, rig: Array, down: bool) -> tuple[float, float]:
    """Tell how much a line stands out near the hog line's place, and how far from there it is.

    At the upper end of the ice or the lower one; grey levels and m.
    """
    colour, within = _across(image, view, rig, down)
    best, least = (0.0, 0.0), LEAST_CONTRAST / 2
    for k in range(BESIDE + 1, len(ABOUT) - BESIDE):
        whole = within[:, [k - BESIDE, k, k + BESIDE]].all(1)
        if whole.sum() < ENOUGH:
            continue
        line = colour[whole, k - ON : k + ON + 1].mean(1)
        one, two = line - colour[whole, k - BESIDE], line - colour[whole, k + BESIDE]
        both = np.where(one * two > 0, np.sign(one) * np.minimum(np.abs(one), np.abs(two)), 0.0)
        # Sweepers may cover half of it: where it stands out most it does by one colour.
        stands_out = np.linalg.norm(both, axis=1)
        most = np.argsort(-stands_out)[:ENOUGH]
        if stands_out[most[-2 - ENOUGH // 10]] < max(best[0], least):
            continue  # less than before, whatever its colour
        way = np.median(both[most], axis=0)
        along = both[most] @ way / max(float(np.linalg.norm(way)), 1e-9)
        contrast = float(np.quantile(along, 0.1))
        unlike = float(np.linalg.norm(np.median((one - two)[most], axis=0)))
        if contrast <= best[0] or unlike >= MOST_UNLIKE * contrast:
            continue
        beside = colour[whole][:, [k - BESIDE, k + BESIDE]]
        ice = np.median(beside[most], axis=(0, 1))
        off = np.linalg.norm(np.concatenate([beside, line[:, None]], axis=1) - ice, axis=2)
        if (off.max(1) < LIKE * contrast).mean() < MOST_BARE:
            best = contrast, float(ABOUT[k])
    return best


def _edge(image: Image, seen: _Tried) -> Marks:
    """Mark a line's edge towards the tee, half-way from it to the ice, where it was seen."""
    view, rig = seen.fit.views[0], seen.fit.rig
    colour, within = _across(image, view, rig, seen.down)
    at = int(np.abs(ABOUT - seen.off).argmin())
    part, end = slice(at - BESIDE, at + 1), -1.0 if seen.down else 1.0
    whole = np.asarray(within[:, part].all(1), bool)
    rises = np.linalg.norm(colour[:, at] - colour[:, at - BESIDE], axis=1)
    most = np.argsort(-np.where(whole, rises, 0.0))[:ENOUGH]
    usual = np.median(colour[most][:, part], axis=0)
    step = usual[-1] - usual[0]
    length = max(float(step @ step), 1e-9)
    found = []
    for first in range(0, len(ACROSS) - EACH + 1, EACH):
        some = np.flatnonzero(whole[first : first + EACH]) + first
        if len(some) < EACH:
            continue
        profile = np.median(colour[some, part], axis=0)
        share = (profile - usual[0]) @ step / length
        if not (abs(share[0]) < 0.5 < share[-1] < 1.5):
            continue  # somebody covers it
        below = np.flatnonzero((share[:-1] < 0.5) & (share[1:] >= 0.5))
        if len(below):
            k = int(below[-1])
            aside = k + (0.5 - share[k]) / (share[k + 1] - share[k])
            off = ABOUT[at - BESIDE] + aside * (ABOUT[1] - ABOUT[0])
            found.append((float(ACROSS[some].mean()), end * (MIDDLE + float(off))))
    ice = np.array(found).reshape(-1, 2)
    size = (image.shape[1], image.shape[0])
    place, ahead = (project(ice + way, view.vector, rig, size) for way in np.diag((0.0, 0.01)))
    normal = (ahead - place) / np.linalg.norm(ahead - place, axis=1, keepdims=True)
    line = np.full(len(ice), HOG_LINE)
    return Marks(line, ice[:, 0], place, normal, np.full(len(ice), EDGE_SD))


def _across(image: Image, view: View, rig: Array, down: bool) -> tuple[Array, NDArray[np.bool_]]:
    """Colours across the hog line's place, from the tee on, and which lie in the picture."""
    size = (image.shape[1], image.shape[0])
    end = -1.0 if down else 1.0
    ice = np.stack(np.broadcast_arrays(ACROSS[:, None], end * (MIDDLE + ABOUT)), axis=-1)
    place, within = pictured(ice, view.vector, rig, size)
    # Far beyond what it was made for a lens folds back into the picture.
    tee, rim = project(np.array([[0.0, 0.0], [0.0, end]]), view.vector, rig, size)
    within[:, 1:] &= np.diff(place, axis=1) @ (rim - tee) > 0
    at = np.where(within[..., None], place, -1.0).astype(np.float32)
    return cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR).astype(np.float64), within
