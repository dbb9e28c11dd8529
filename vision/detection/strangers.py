"""Stones of which nothing is known yet: coloured caps first, then any that have a stone's shape.

By colour a cap is told from almost everything on the ice, so this is looked for first. Two teams
play: where fewer than two colours convince, the picture may have lost its contrast or never had
colours, or caps may be left that are black, white or dull. These show what every stone does, two
concentric circles of known size, whatever is within them. Little else on the ice is so round; and
what is, is rarely of the granite that other stones there are of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import (
    BY_SHAPE,
    MOST_COLOURS,
    Appearance,
    Colour,
    by_colour,
    convincing,
    learn,
)
from curlshot.vision.detection.contrast import alike
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.patch import is_plain
from curlshot.vision.detection.rays import Look
from curlshot.vision.detection.seek import Candidates
from curlshot.vision.detection.shape import NO_BALLOT, elected
from curlshot.vision.detection.stones import (
    Findings,
    Search,
    apart,
    measured,
    search_picture,
    sought_in,
)
from curlshot.vision.optics.cameras import Cameras
from curlshot.vision.video.colour import chroma

Array = NDArray[np.float64]

UNKNOWN, SAME = -0.25, 0.05
"""What evidence by shape counts less than that by colours where nothing is known of the granite,
and more where it is that of other stones. Of 127 real frames without colours (some 600 stones) the
roundest print has 1.6 and clothes 1.6, of granite like that of the stones there 1.3."""


MOST_HUE = 36.0
"""Distance from grey, L*a*b* units, from which on what is around a disc is no granite but paint."""

ODD = -0.9
"""The same where such stones are not made as usual: printed letters and rings that pass for some
have up to 2.2, flat stones that are drawn with caps of any size 2.3 to 3."""

ASLANT, OTHER = 0.6, 1.15
"""Slant of the view from which on flat granite looks otherwise than one that falls off, and how
much more evidence another make must have than one that is more usual."""

LARGE = 1.22
"""How much larger than usual caps are sought where no others convince: what is sought as usual ones
answers up to there."""


def strangers(
    looks: Sequence[Look],
    disc: Stone,
    search: Search,
    made: bool = False,
    rough: bool = False,
) -> tuple[list[Findings], Stone]:
    """Search a few pictures of one clip for stones of any colour.

    Parameters
    ----------
    looks : sequence of Look
        At pictures, with the places of stones that need not be found.
    disc : Stone
        Size of the stones, or `curlshot.vision.detection.stones.plain_disc`.
    search : Search
        Where stones are sought and what they must show.
    made : bool
        Whether it is known that stones here are made like that; else it is what they usually are.
    rough : bool
        Whether a finer search follows where this one finds little: how stones that no colour tells
        are made, and caps larger than what is sought, are left to it.

    Returns
    -------
    found : list of Findings
        One per picture. Of those that shape alone tells the convincing ones.
    disc : Stone
        How they are made.
    """
    found, likely = _found(looks, None, disc, search, made or is_plain(disc), rough)
    sure = _sure(found)
    if is_plain(disc) or len(by_colour(sure)) >= MOST_COLOURS:
        return found, likely
    made, usual = made or rough or bool(sure), likely if sure else disc
    beside = [_beside(look, one.stones) for look, one in zip(looks, found, strict=True)]
    others, like = _found(beside, BY_SHAPE, usual, search, made)
    unknown = UNKNOWN if like == usual else ODD
    round_ones = [one.stones for one in others]
    sure += convincing(weighed(stone, None, unknown) for some in round_ones for stone in some)
    seen = learn(sure)
    granite = None if seen is None else seen.granite
    both = [
        Findings(
            tuple(
                apart([*one.stones, *convincing(weighed(s, granite, unknown) for s in more)], like)
            ),
            one.refused,
        )
        for one, more in zip(found, round_ones, strict=True)
    ]
    return both, like if sure else disc


def _found(
    looks: Sequence[Look],
    like: Appearance | None,
    disc: Stone,
    search: Search,
    made: bool,
    rough: bool = False,
) -> tuple[list[Findings], Stone]:
    """Search pictures for what looks like that, made as most of the places there say."""
    sought = _sought(looks, like, disc, search)
    if made:
        return _measured(looks, sought, disc, search), disc
    usual = _best(looks, sought, like, elected(_say(sought), disc), search)
    if rough or _sure(usual[0]):
        return usual
    sought = _sought(looks, like, replace(disc, cap_radius=LARGE * disc.cap_radius), search)
    large = [one for one in elected(_say(sought), disc) if one.cap_radius > disc.cap_radius]
    other = _best(looks, sought, like, large, search) if large else usual
    return other if _sure(other[0]) else usual


def _best(
    looks: Sequence[Look],
    sought: Sequence[Candidates],
    like: Appearance | None,
    discs: Sequence[Stone],
    search: Search,
) -> tuple[list[Findings], Stone]:
    """Measure stones as made in each of these ways, falling off or flat; take what shows most."""
    best, most = None, -1.0
    slants = [
        Cameras.of([look.camera], [len(each.places)]).slants(each.places)
        for look, each in zip(looks, sought, strict=True)
    ]
    aslant = any((np.hypot(*slant.T) > ASLANT).any() for slant in slants)
    flat = [replace(one, rim_height=one.cap_height) for one in discs if aslant]
    for one in [*discs, *flat]:
        found = _measured(looks, sought, one, search)
        shown = sum(stone.score for some in found for stone in some.stones)
        if shown > (OTHER if best else 1) * most:
            best, most = (found, one), shown
    assert best is not None
    return best


def _say(sought: Sequence[Candidates]) -> Array:
    return np.asarray(np.sum([NO_BALLOT, *(each.say for each in sought)], axis=0))


def _sought(
    looks: Sequence[Look], like: Appearance | None, disc: Stone, search: Search
) -> list[Candidates]:
    return [sought_in(look.picture, look.camera, like, disc, search) for look in looks]


def _measured(
    looks: Sequence[Look], sought: Sequence[Candidates], disc: Stone, search: Search
) -> list[Findings]:
    return [measured(*each, disc, search) for each in zip(looks, sought, strict=True)]


def _sure(found: Sequence[Findings]) -> list[Detection]:
    return convincing(stone for one in found for stone in one.stones)


def _beside(look: Look, found: Sequence[Detection]) -> Look:
    """Look beside stones of which those found convince."""
    sure = np.array([(s.x, s.y) for s in convincing(found)]).reshape(-1, 2)
    return replace(look, places=np.concatenate([look.places, sure]))


def by_shape(
    look: Look, found: Sequence[Detection], disc: Stone, search: Search
) -> tuple[Detection, ...]:
    """Seek what has a stone's shape beside those found that convince; see `weighed`."""
    known = _beside(look, found).places
    return search_picture(look.picture, look.camera, BY_SHAPE, disc, search, known=known).stones


def weighed(stone: Detection, granite: Colour | None, unknown: float = UNKNOWN) -> Detection:
    """Give a stone told by its shape the evidence that it has beside those told by colours."""
    if not len(stone.granite_samples):
        return stone._replace(score=stone.score + unknown)
    own = np.median(stone.granite_samples, axis=0)
    if chroma(own) > MOST_HUE:
        return stone._replace(score=0.0)
    same = granite is not None and alike(own, granite.mean)
    return stone._replace(score=stone.score + (SAME if same else unknown))
