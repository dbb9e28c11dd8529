"""Stones of which nothing is known yet: coloured caps first, then any that have a stone's shape.

By colour a cap is told from almost everything on the ice, so this is looked for first. Two teams
play: where fewer than two colours convince, the picture may have lost its contrast or never had
colours, or caps may be left that are black, white or dull. These show what every stone does, two
concentric circles of known size, whatever is within them. Little else on the ice is so round; and
what is, is rarely of the granite that other stones there are of.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from data.sheet import Stone
from vision.detection.appearance import BY_SHAPE, MOST_COLOURS, Colour, by_colour, convincing, learn
from vision.detection.contrast import alike
from vision.detection.patch import is_plain
from vision.detection.rays import Look
from vision.detection.sighting import Sighting
from vision.detection.stones import Findings, Search, apart, search_picture
from vision.film.lab import chroma

UNKNOWN, SAME = -0.25, 0.05
"""What evidence by shape counts less than that by colours where nothing is known of the granite,
and more where it is that of other stones. Of 127 real frames without colours (some 600 stones) the
roundest print has 1.6 and clothes 1.6, of granite like that of the stones there 1.3."""


MOST_HUE = 36.0
"""Distance from grey, L*a*b* units, from which on what is around a disc is no granite but paint."""


def strangers(looks: Sequence[Look], disc: Stone, search: Search) -> list[Findings]:
    """Search a few pictures of one clip for stones of any colour.

    Parameters
    ----------
    looks : sequence of Look
        At pictures, with the places of stones that need not be found.
    disc : Stone
        Size of the stones, or `vision.detection.stones.plain_disc`.
    search : Search
        Where stones are sought and what they must show.

    Returns
    -------
    list of Findings
        One per picture. Of those that shape alone tells the convincing ones.
    """
    found = [
        search_picture(look.picture, look.camera, None, disc, search, None, look.places)
        for look in looks
    ]
    sure = convincing(stone for one in found for stone in one.stones)
    if is_plain(disc) or len(by_colour(sure)) >= MOST_COLOURS:
        return found
    round_ones = [
        by_shape(look, one.stones, disc, search) for look, one in zip(looks, found, strict=True)
    ]
    sure += convincing(weighed(stone, None) for some in round_ones for stone in some)
    seen = learn(sure)
    granite = None if seen is None else seen.granite
    return [
        Findings(
            tuple(apart([*one.stones, *convincing(weighed(s, granite) for s in more)], disc)),
            one.refused,
        )
        for one, more in zip(found, round_ones, strict=True)
    ]


def by_shape(
    look: Look, found: Sequence[Sighting], disc: Stone, search: Search
) -> tuple[Sighting, ...]:
    """Seek what has a stone's shape beside those found that convince; see `weighed`."""
    sure = np.array([(s.x, s.y) for s in convincing(found)]).reshape(-1, 2)
    known = np.concatenate([look.places, sure])
    return search_picture(look.picture, look.camera, BY_SHAPE, disc, search, None, known).stones


def weighed(stone: Sighting, granite: Colour | None) -> Sighting:
    """Give a stone told by its shape the evidence that it has beside those told by colours."""
    if not len(stone.granite_samples):
        return stone._replace(score=stone.score + UNKNOWN)
    own = np.median(stone.granite_samples, axis=0)
    if chroma(own) > MOST_HUE:
        return stone._replace(score=0.0)
    same = granite is not None and alike(own, granite.mean)
    return stone._replace(score=stone.score + (SAME if same else UNKNOWN))
