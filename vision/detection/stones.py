"""Stones in one picture: sought on the rectified ice, measured on rays, or refused for a reason.

A stone is a disc of grey granite with a saturated cap of known size, a known height above the ice.
Where one may be, the rectified ice tells (`curlshot.vision.detection.seek`); whether it is one and
where its centre lies, the picture itself (`curlshot.vision.detection.measure`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.config import SearchConfig
from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.appearance import Appearance
from curlshot.vision.detection.detection import Detection, Refusal
from curlshot.vision.detection.measure import Measures, measure_discs
from curlshot.vision.detection.patch import EFFORT, is_plain
from curlshot.vision.detection.placing import detections, placed_by
from curlshot.vision.detection.rays import Look, Rays
from curlshot.vision.detection.samples import CLEARLY, well_within
from curlshot.vision.detection.seek import Bounds, Candidates, seek
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.picture import Picture

Array = NDArray[np.float64]

NEAREST = 1.6
"""Nearer to each other than so many radii no two discs are seen: two, if places did not err."""

ALIKE = 12.0
"""Difference of colours, L*a*b* units, below which ground is seen within a rim: it is a ring, drawn
or projected. What of its colour a clip spreads as it is coded makes 7 in the mean of one of 15 px,
and less than this on all but a fifth of the rays."""

WITHIN, BEYOND = 0.6, 1.15
"""Radii up to which, and from which on, samples are not of a rim, as shares of a disc's."""

LEAST_UNLIKE = 0.25
"""Share of the rays on which a disc is unlike what is around it: paint may be like it elsewhere."""


@dataclass(frozen=True)
class Search:
    """Where stones are searched for in one pass, and what they must show.

    Attributes
    ----------
    half_width, half_length : float
        Stones are searched for on |x| and |y| up to these, m.
    radius_px : float
        Radius of a disc on the rectified map, px.
    min_response : float
        Template response (0 to 2) from which a place is examined.
    min_visible_ratio, min_evidence, min_repeated_evidence, min_disc_evidence : float
        See `curlshot.config.SearchConfig`.
    max_centre_shift_ratio : float
        See `curlshot.config.SearchConfig`.
    """

    half_width: float
    half_length: float
    radius_px: float
    min_response: float
    min_visible_ratio: float
    min_evidence: float
    min_repeated_evidence: float
    min_disc_evidence: float
    max_centre_shift_ratio: float

    @classmethod
    def of(cls, config: SearchConfig, *, clip: bool = False) -> Search:
        """Return the search of a single frame, or of a frame of a `clip`, on a coarser map."""
        return cls(
            half_width=config.search_half_width,
            half_length=config.search_half_length,
            radius_px=config.tracking_radius_px if clip else config.search_radius_px,
            min_response=config.tracking_min_response if clip else config.search_min_response,
            min_visible_ratio=config.min_visible_ratio,
            min_evidence=config.min_evidence,
            min_repeated_evidence=config.min_repeated_evidence,
            min_disc_evidence=config.min_disc_evidence,
            max_centre_shift_ratio=config.max_centre_shift_ratio,
        )


SEARCH = Search.of(SearchConfig())
"""For a single frame, which has one chance."""

FOLLOWING = Search.of(SearchConfig(), clip=True)
"""For a clip, where the next frames show what one hides."""


@dataclass(frozen=True)
class Findings:
    """What a search of one picture gave: the stones, strongest first, and what was refused."""

    stones: tuple[Detection, ...] = ()
    refused: tuple[Refusal, ...] = ()


def plain_disc(radius: float) -> Stone:
    """Return a flat disc of which nothing but the radius is known."""
    return Stone(radius=radius, cap_radius=0.0, cap_height=0.0)


def search_picture(
    image: Picture,
    camera: Camera,
    appearance: Appearance | None = None,
    disc: Stone = STONE,
    search: Search = SEARCH,
    bounds: Bounds | None = None,
    known: Array | None = None,
) -> Findings:
    """Find and measure the stones in one picture, and say what was refused and why.

    Parameters
    ----------
    image : Picture or ndarray of shape (h, w, 3)
        BGR.
    camera : Camera
        The picture's camera; where its position is known, the height of the cap is taken out.
    appearance : Appearance, optional
        What stones look like here, from `learn`, or `BY_SHAPE`; without it, what any stone with a
        coloured cap looks like.
    disc : Stone
        Radius, cap radius and cap height; `plain_disc` for a disc without a cap.
    search : Search
        Where stones are sought and what they must show.
    bounds : (x0, x1, y0, y1), optional
        The part of the ice, m; all of it where left out.
    known : ndarray, shape (n, 2), optional
        Places of stones that need not be found, m: nothing near them is looked at.

    Returns
    -------
    Findings
        The stones no nearer to each other than discs can be.
    """
    return measured(
        Look(image, camera, np.empty((0, 2)) if known is None else known),
        sought_in(image, camera, appearance, disc, search, bounds),
        disc,
        search,
    )


def sought_in(
    image: Picture,
    camera: Camera,
    appearance: Appearance | None,
    disc: Stone,
    search: Search,
    bounds: Bounds | None = None,
) -> Candidates:
    """Look in a picture for places of stones; see `search_picture`."""
    area = whole_ice(camera, disc, search) if bounds is None else bounds
    return seek(
        image, camera, appearance, disc, area,
        radius_px=search.radius_px, least=search.min_response,
    )  # fmt: skip


def measured(look: Look, sought: Candidates, disc: Stone, search: Search) -> Findings:
    """Measure what was sought in a picture; at the places of the look nothing need be found."""
    places, known = sought.places, look.places
    if len(known) and len(places):
        new = np.hypot(*(places[:, None] - known).transpose(2, 0, 1)).min(1) > NEAREST * disc.radius
        places = places[new]
    refused: list[Refusal] = []
    # The second time from the centre that the first has found, roughly and without the handle.
    rough = (
        replace(search, min_evidence=search.min_repeated_evidence),
        replace(EFFORT, rounds=1, light=False, handle_rings=0),
    )
    for least, effort in (rough, (search, EFFORT)):
        if not len(places):
            return Findings((), tuple(refused))
        looks = [replace(look, places=places)]
        seen = measure_discs(looks, sought.appearance, disc, effort)
        faults = judge(seen, disc, least)
        refused += [
            Refusal(float(places[i, 0]), float(places[i, 1]), float(seen.evidence[i]), fault)
            for i, fault in enumerate(faults)
            if fault
        ]
        chosen = np.array([i for i, fault in enumerate(faults) if not fault], np.intp)
        places = seen.centre[chosen]
    found = detections(seen, looks, chosen, disc)
    stones = [
        with_samples(detection, seen, i, disc)
        for i, detection in zip(chosen.tolist(), found, strict=True)
    ]
    (placed,) = placed_by([look.camera], [apart(stones, disc)], disc)
    return Findings(tuple(placed), tuple(refused))


def whole_ice(camera: Camera, disc: Stone, search: Search) -> Bounds:
    """Part of the ice on which to look: x0, x1, y0, y1, m."""
    if not is_plain(disc):
        return -search.half_width, search.half_width, -search.half_length, search.half_length
    width, height = camera.size
    corners = camera.ice(np.array([[0, 0], [width, 0], [0, height], [width, height]], float))
    (x0, y0), (x1, y1) = corners.min(0).tolist(), corners.max(0).tolist()
    return x0, x1, y0, y1


def judge(seen: Measures, disc: Stone, search: Search) -> list[str]:
    """Say of each place why it shows no stone; an empty text where it does."""
    plain = is_plain(disc)
    least = search.min_disc_evidence if plain else search.min_evidence
    size = disc.radius if plain else disc.cap_radius
    faults = np.full(len(seen.ok), "", dtype=object)
    beside = hollow = np.zeros(len(seen.ok), bool)
    if plain:
        hollow = _hollow(seen.rays, disc)
    else:
        beside = np.abs(seen.centre[:, 0]) > search.half_width - 0.4 * disc.radius
    for wrong, why in (
        (beside, "outside the sheet"),
        (seen.evidence + seen.excused < least, "too little resemblance to a stone"),
        (seen.shift > search.max_centre_shift_ratio * size, "its edges belong to something else"),
        (seen.visible < search.min_visible_ratio, "barely visible"),
        (hollow, "an empty ring"),
        (~seen.ok, "no cap surrounded by granite" if not plain else "no circle of the right size"),
    ):
        faults[wrong] = why
    return [str(fault) for fault in faults]


def _hollow(rays: Rays, disc: Stone) -> NDArray[np.bool_]:
    """Whether there is the same within a rim as beyond it, shape (n,)."""
    share = rays.radius / disc.radius
    within, beyond = (
        np.median(rays.lab[:, :, part].astype(float), axis=2)
        for part in (share < WITHIN, share > BEYOND)
    )
    unlike = np.linalg.norm(within - beyond, axis=2) > ALIKE
    seen = rays.inside[:, :, share > BEYOND].all(2)
    return np.asarray((unlike & seen).sum(1) < LEAST_UNLIKE * seen.sum(1))


def with_samples(found: Detection, seen: Measures, index: int, disc: Stone) -> Detection:
    """Add what the place's samples say of the colours of cap and granite, for learning."""
    cap, ring = well_within(seen.rays.radius, disc)
    lab, worth = seen.rays.lab[index], seen.worth[index]
    return found._replace(
        cap_samples=lab[:, cap][worth[:, cap] > CLEARLY][::7].astype(float),
        granite_samples=lab[:, ring][worth[:, ring] < -CLEARLY][::5].astype(float),
    )


def apart(found: Sequence[Detection], disc: Stone) -> list[Detection]:
    """Keep the better of any two that overlap more than two discs can."""
    kept: list[Detection] = []
    for item in sorted(found, key=lambda s: -s.score):
        if all(np.hypot(item.x - k.x, item.y - k.y) > NEAREST * disc.radius for k in kept):
            kept.append(item)
    return kept
