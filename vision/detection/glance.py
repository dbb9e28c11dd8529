"""Stones in a few pictures of one clip, each looked at on its own: what was taken, what refused."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

import numpy as np

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.appearance import MOST_COLOURS, UNLIKE, Appearance, convincing, learn
from curlshot.vision.detection.balance import brightening, tones
from curlshot.vision.detection.detection import Detection, Refusal
from curlshot.vision.detection.measure import measure_discs
from curlshot.vision.detection.patch import is_plain
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.relief import without_handle
from curlshot.vision.detection.stones import NEAREST, SEARCH, Findings, Search, search_picture
from curlshot.vision.detection.strangers import by_shape, strangers, weighed
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.picture import Image, brightened, image_of, toned

BOTH_MEASURES = 1.2
"""Least mean of the two evidences of a stone: by its shape, or before any was known, and by what
was learned. Of 35 real frames, changed in 13 ways, 14 stones that one of the two missed have 1.2 to
1.8; of 16 other things one has more than 1.2."""


def glance(
    pictures: Sequence[tuple[Image, Camera]], disc: Stone = STONE, search: Search = SEARCH
) -> list[Findings]:
    """Search each picture, knowing what the stones of all of them look like.

    Parameters
    ----------
    pictures : sequence of (ndarray of shape (h, w, 3), Camera)
    disc : Stone
        Size of the stones, or `plain_disc(radius)` for other discs.
    search : Search
        Where stones are searched for, and what they must show.

    Returns
    -------
    list of Findings
        One per picture, with the places that were refused and why.
    """
    if not is_plain(disc):
        pictures = [(_lit(image, camera), camera) for image, camera in pictures]
    first, appearance, made = _first(pictures, disc, search)
    if appearance is not None:
        image, camera = pictures[0]
        table = tones(image, camera, appearance.granite)
        if table is not None:  # what was found is in tones too dark to tell all of it
            lifted = [(image_of(toned(image, table)), camera) for image, camera in pictures]
            anew = _first(lifted, disc, search)
            if anew[1] is not None:  # else what seemed to be granite belongs to no stone
                pictures, (first, appearance, made) = lifted, anew
    if appearance is None:
        return first
    again = [search_picture(image, camera, appearance, made, search) for image, camera in pictures]
    return _with_handles(
        [
            _with_strangers(image, camera, known, other, appearance, made, search)
            for (image, camera), known, other in zip(pictures, again, first, strict=True)
        ]
    )


def _first(
    pictures: Sequence[tuple[Image, Camera]], disc: Stone, search: Search
) -> tuple[list[Findings], Appearance | None, Stone]:
    """Search pictures for unknown stones; learn what these look like and how they are made."""
    looks = [Look(image, camera, np.empty((0, 2))) for image, camera in pictures]
    first, made = strangers(looks, disc, search)
    first = _with_handles(first)
    return first, learn(convincing(stone for found in first for stone in found.stones)), made


def _with_handles(found: Sequence[Findings]) -> list[Findings]:
    """Refuse what has no handle, as paint, where others have."""
    bare = iter(without_handle([stone for one in found for stone in one.stones]).tolist())
    out = []
    for one in found:
        stones, refused = [], [*one.refused]
        for stone in one.stones:
            if next(bare):
                refused.append(Refusal(stone.x, stone.y, stone.score, "no handle on it"))
            else:
                stones.append(stone)
        out.append(Findings(tuple(stones), tuple(refused)))
    return out


def _lit(image: Image, camera: Camera) -> Image:
    """Give a picture bright enough to tell colours."""
    return image_of(brightened(image, np.full(3, brightening(image, camera))))


def _with_strangers(
    image: Image,
    camera: Camera,
    known: Findings,
    other: Findings,
    look: Appearance,
    disc: Stone,
    search: Search,
) -> Findings:
    """Add stones that were found before any was known, or by their shape, and then passed over.

    One of a colour of which none convinces stays as it is. One of a known colour stays if it shows
    enough by both measures together: on paint of its own colour each misses much of it.
    """

    def apart(place: Detection | Refusal, stones: Sequence[Detection]) -> bool:
        least = NEAREST * disc.radius
        return all(hypot(place.x - s.x, place.y - s.y) > least for s in stones)

    some_are_strange = len(look.caps) < MOST_COLOURS
    left = [stone for stone in other.stones if apart(stone, known.stones)]
    if not some_are_strange:
        here = Look(image, camera, np.empty((0, 2)))
        taken = (*known.stones, *left)
        shapes = [weighed(s, look.granite) for s in by_shape(here, taken, disc, search)]
        left += [stone for stone in convincing(shapes) if apart(stone, taken)]
    if not left:
        return known
    places = np.array([(stone.x, stone.y) for stone in left])
    seen = measure_discs([Look(image, camera, places)], look, disc)
    more = [
        stone
        for stone, ok, evidence in zip(left, seen.ok, seen.evidence, strict=True)
        if (some_are_strange and look.nearest(stone.colour)[1] > UNLIKE)
        or (ok and 0.5 * (stone.score + evidence) > BOTH_MEASURES)
    ]
    refused = tuple(place for place in known.refused if apart(place, more))
    return Findings((*known.stones, *more), refused)
