"""Stones of which nothing is known yet: coloured caps first, then any that are not as granite is.

By colour a cap is told from almost everything on the ice, so this is looked for first. Two teams
play: where fewer than two colours convince, the picture may have lost its contrast, or caps may be
left that are black or white, or whose granite the picture has given a tinge. These differ from
their granite by their lightness. Those that differ from it by little, or whose granite is as light
as haze or too much light makes it, are sought where the granite is known from the other team.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from data.sheet import Stone
from vision.appearance import (
    MOST_COLOURS,
    Guess,
    any_dull_stone,
    any_dull_stone_of,
    any_grey_stone,
    any_grey_stone_of,
    any_veiled_stone,
    by_colour,
    convincing,
    learn,
)
from vision.patch import is_plain
from vision.rays import Look
from vision.sighting import Sighting
from vision.stones import Findings, Search, search_picture


def strangers(looks: Sequence[Look], disc: Stone, search: Search) -> list[Findings]:
    """Search a few pictures of one clip for stones of any colour.

    Parameters
    ----------
    looks : sequence of Look
        At pictures, with the places of stones that need not be found.
    disc : Stone
        Size of the stones, or `vision.stones.plain_disc`.
    search : Search
        Where stones are sought and what they must show.

    Returns
    -------
    list of Findings
        One per picture. Of those that only contrast or lightness tell the convincing ones: a cap
        of hair with grey about it is no stone.
    """
    found = [
        search_picture(look.picture, look.camera, None, disc, search, None, look.places)
        for look in looks
    ]
    if is_plain(disc):
        return found
    first = not any(len(look.places) for look in looks)
    for guess in (any_veiled_stone, any_grey_stone) if first else (any_grey_stone,):
        if _colours(found) < MOST_COLOURS:
            found = _with_more(found, looks, guess, disc, search)
    if first and not _colours(found):
        found = _with_more(found, looks, any_dull_stone, disc, search)
    if _colours(found) == 1:
        seen = learn(_convincing(found))
        if seen is not None and seen.granite is not None:
            hues = () if all(cap.grey for cap in seen.caps) else (any_dull_stone_of,)
            for guess_of in (*hues, any_grey_stone_of):
                if _colours(found) == 1:
                    found = _with_more(found, looks, guess_of(seen.granite), disc, search)
    return found


def _convincing(found: Sequence[Findings]) -> list[Sighting]:
    return convincing(stone for one in found for stone in one.stones)


def _colours(found: Sequence[Findings]) -> int:
    """Count the colours of caps that convince."""
    return len(by_colour(_convincing(found)))


def _with_more(
    found: Sequence[Findings], looks: Sequence[Look], guess: Guess, disc: Stone, search: Search
) -> list[Findings]:
    """Add what convinces by another guess."""
    more = []
    for one, look in zip(found, looks, strict=True):
        seen = np.array([(stone.x, stone.y) for stone in one.stones]).reshape(-1, 2)
        places = np.concatenate([look.places, seen])
        other = search_picture(look.picture, look.camera, guess, disc, search, None, places)
        more.append(Findings((*one.stones, *convincing(other.stones)), one.refused))
    return more
