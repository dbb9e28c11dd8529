"""Stones of which nothing is known yet: coloured caps first, then any that are not as granite is.

By colour a cap is told from almost everything on the ice, so this is looked for first. Two teams
play, though: where fewer than two colours convince, caps that are black or white, or whose
granite the picture has given a tinge, may be left, and these differ from their granite by their
lightness.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from data.sheet import Stone
from vision.appearance import MOST_COLOURS, any_grey_stone, by_colour, convincing
from vision.camera import Camera
from vision.patch import is_plain
from vision.picture import Picture
from vision.stones import Findings, Search, search_picture

Array = NDArray[np.float64]


def strangers(
    views: Sequence[tuple[Picture, Camera, Array]], disc: Stone, search: Search
) -> list[Findings]:
    """Search a few pictures of one clip for stones of any colour.

    Parameters
    ----------
    views : sequence of (Picture, Camera, ndarray of shape (n, 2))
        Pictures, their cameras and the places of stones that need not be found, m.
    disc : Stone
        Size of the stones, or `vision.stones.plain_disc`.
    search : Search
        Where stones are sought and what they must show.

    Returns
    -------
    list of Findings
        One per picture. Of those told by their lightness only the convincing ones: a cap of hair
        with grey about it is no stone.
    """
    first = [
        search_picture(image, camera, None, disc, search, None, known)
        for image, camera, known in views
    ]
    colours = by_colour(convincing(stone for found in first for stone in found.stones))
    if is_plain(disc) or len(colours) >= MOST_COLOURS:
        return first
    return [
        _with_shades(found, view, disc, search) for found, view in zip(first, views, strict=True)
    ]


def _with_shades(
    found: Findings, view: tuple[Picture, Camera, Array], disc: Stone, search: Search
) -> Findings:
    """Add what only its lightness tells."""
    image, camera, known = view
    seen = np.array([(stone.x, stone.y) for stone in found.stones]).reshape(-1, 2)
    more = search_picture(
        image, camera, any_grey_stone, disc, search, None, np.concatenate([known, seen])
    )
    return Findings((*found.stones, *convincing(more.stones)), found.refused)
