"""Which team a stone is of, in words."""

from __future__ import annotations

import re
from colorsys import rgb_to_hsv

import pandas as pd

from curlshot.data.tracks import teams

_HUES = (
    *((15, "red"), (42, "orange"), (70, "yellow"), (165, "green"), (195, "teal"), (255, "blue")),
    *((300, "purple"), (335, "pink"), (361, "red")),
)
"""Words for hues up to an angle, degrees."""


def team_names(tracks: pd.DataFrame) -> dict[str, str | None]:
    """Name the team of each stone, None where it is not known.

    Colours (``#rrggbb``) become words, unless two teams would have the same one.
    """
    known = teams(tracks)
    words = {team: colour_word(team) for team in set(known.values())}
    if len(set(words.values())) < len(words):
        words = {team: team for team in words}
    return {stone: words[team] or None for stone, team in known.items()}


def colour_word(colour: str) -> str:
    """Return the word for a colour ``#rrggbb``; any other text as it is."""
    if not re.fullmatch(r"#[0-9a-fA-F]{6}", colour):
        return colour
    red, green, blue = (int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5))
    hue, saturation, value = rgb_to_hsv(red, green, blue)
    if value < 0.2:
        return "black"
    if saturation < 0.2:
        return "white" if value > 0.75 else "grey"
    return next(word for top, word in _HUES if 360 * hue < top)
