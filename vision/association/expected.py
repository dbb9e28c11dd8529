"""Stones measured where they are expected, in one picture or in several at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.measure import Measures, measure_discs
from curlshot.vision.detection.patch import EFFORT
from curlshot.vision.detection.placing import detections
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.seek import seek_about
from curlshot.vision.detection.stones import FOLLOWING, Search, judge

Array = NDArray[np.float64]

FOLLOWED = replace(EFFORT, coarse=1.0)
"""For a stone of which it is known that it is about there. Hue is coded for every other pixel, and
in blocks: with paint of another hue beyond the granite, caps in Motion JPEG whose radius is 17 px
came out by 0 to 3 px too large, and a stone in plain view was taken for none."""

ROUGH = replace(FOLLOWED, light=False, handle_rings=0)
"""For a place from which another one follows that is measured anew."""

ON_COURSE = 0.15
"""Within this many radii of where it is expected a stone need not be looked for."""

SETTLED = 0.02
"""Measured from within this many radii of its centre, a stone's place depends no more on where."""

SAME = 0.1
"""Response that is strongest within this many radii of where a stone was measured is its own: of
151 doubtful ones in eleven clips 129 answered so, and none of these was beside."""

NEARBY = 0.35
"""How far from where it is expected a stone is measured, in radii."""


def look_on_course(
    looks: Sequence[Look],
    appearance: Appearance | None,
    disc: Stone = STONE,
    search: Search = FOLLOWING,
) -> list[Detection | None]:
    """Measure stones that have kept their course.

    Parameters
    ----------
    looks : sequence of Look
        Pictures, each with the places where stones are expected.
    appearance : Appearance or None
        What stones look like here; not used for a plain disc.
    disc : Stone
        Size of the stones, or `curlshot.vision.detection.stones.plain_disc`.
    search : Search
        What they must show.

    Returns
    -------
    list of Detection or None
        One per place, in their order; None where there is no stone.
    """
    seen = measure_discs(looks, appearance, disc, FOLLOWED)
    settled = seen.shift < SETTLED * disc.radius
    out = _found(seen, looks, settled, disc, search)
    # The edges that were chosen from beside the centre draw the circle towards there.
    near = np.flatnonzero(~settled & (seen.shift < ON_COURSE * disc.radius) & seen.ok)
    if len(near):
        looks = _moved(looks, seen.centre, near)
        seen = measure_discs(looks, appearance, disc, FOLLOWED)
        settled = seen.shift < SETTLED * disc.radius
        found = _found(seen, looks, settled, disc, search)
        for i, detection in zip(near.tolist(), found, strict=True):
            out[i] = detection
    return out


def look_beside(
    look: Look,
    seen: Sequence[Detection | None],
    appearance: Appearance | None,
    disc: Stone = STONE,
    search: Search = FOLLOWING,
) -> list[Detection | None]:
    """Measure stones that have left their course by a little: as `look_on_course`.

    Parameters
    ----------
    seen : sequence of Detection or None
        What was seen on their course: where nothing answers more strongly beside it than there,
        nothing is measured.
    """
    about = seek_about(
        look.picture, look.camera, look.places, appearance, disc,
        radius_px=search.radius_px, reach=NEARBY,
    )  # fmt: skip
    known = np.array([(inf, inf) if s is None else (s.x, s.y) for s in seen]).reshape(-1, 2)
    others = np.flatnonzero(np.hypot(*(about - known).T) > SAME * disc.radius)
    out: list[Detection | None] = [None] * len(about)
    if not len(others):
        return out
    (at,) = _moved([look], about, others)
    found = measure_discs([at], appearance, disc, ROUGH)
    within = found.ok & (found.shift < NEARBY * disc.radius)
    looks = [replace(at, places=np.where(within[:, None], found.centre, at.places))]
    found = measure_discs(looks, appearance, disc, FOLLOWED)
    beside = _found(found, looks, np.ones(len(others), bool), disc, search)
    for i, detection in zip(others.tolist(), beside, strict=True):
        out[i] = detection
    return out


def _moved(looks: Sequence[Look], places: Array, chosen: NDArray[np.intp]) -> list[Look]:
    """Look again at the chosen ones, at these places."""
    ends = np.cumsum([len(look.places) for look in looks])
    parts = np.split(chosen, np.searchsorted(chosen, ends[:-1]))
    again = []
    for look, part, end in zip(looks, parts, ends.tolist(), strict=True):
        own = part - (end - len(look.places))
        drift = None if look.drift is None else look.drift[own]
        if len(part):
            again.append(replace(look, places=places[part], drift=drift))
    return again


def _found(
    seen: Measures,
    looks: Sequence[Look],
    right: NDArray[np.bool_],
    disc: Stone,
    search: Search,
) -> list[Detection | None]:
    """Give the detections where places show stones and are the right ones, else None."""
    out: list[Detection | None] = [None] * len(right)
    faults = judge(seen, disc, replace(search, min_evidence=search.min_repeated_evidence))
    chosen = np.array([i for i, fault in enumerate(faults) if right[i] and not fault], np.intp)
    found = detections(seen, looks, chosen, disc)
    for i, detection in zip(chosen.tolist(), found, strict=True):
        out[i] = detection
    return out
