"""Names of stones on a plan: inside the stone where they fit, else where there is room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from curlshot.report.figures.parts import Array, short

Box = tuple[Array, Array]
"""Lower left and upper right corner, m."""

_SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))


def name_stones(
    ax: Axes,
    places: Mapping[str, Array],
    colours: Mapping[str, str],
    radius: float,
    scale: float,
) -> None:
    """Write the names of stones on a plan whose limits are set and whose lines are drawn.

    Parameters
    ----------
    ax : Axes
        The plan, m.
    places : mapping of str to (2,) array
        Where the stones lie, m.
    colours : mapping of str to str
        Of the names.
    radius : float
        Of the stones, m.
    scale : float
        Inches of the figure per metre.
    """
    inside = 72 * scale * radius  # the stone's radius in points
    size = min(9.0, max(6.5, inside))
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    sheet = np.array([left, bottom]), np.array([right, top])
    lines = np.concatenate(
        [np.empty((0, 2)), *(np.asarray(line.get_xydata(), float) for line in ax.lines)]
    )
    em = size / 72 / scale  # height of the letters in metres
    taken = [(place - radius, place + radius) for place in places.values()]
    for name, place in places.items():
        text: dict[str, Any] = {
            "color": colours[name], "weight": "bold", "fontsize": size, "zorder": 7,
            "va": "center", "ha": "center",
            "path_effects": [withStroke(linewidth=2, foreground="white")],
        }  # fmt: skip
        label = short(name)
        half = np.array([0.36 * em * len(label), 0.6 * em])
        if np.hypot(*half) < radius:
            ax.text(place[0], place[1], label, **text)
            continue
        boxes = []
        for side in _SIDES:
            centre = place + np.array(side) * (radius + half + 0.2 * em)
            boxes.append((centre - half, centre + half))
        box = min(boxes, key=lambda b: _cost(b, taken, lines, sheet))
        taken.append(box)
        x, y = (box[0] + box[1]) / 2
        ax.text(x, y, label, **text)


def _cost(box: Box, taken: Sequence[Box], lines: Array, sheet: Box) -> float:
    """Area of a label's box that is taken or outside the picture, and a little for lines in it."""
    whole = float(np.prod(box[1] - box[0]))
    crossed = bool(((lines > box[0]) & (lines < box[1])).all(axis=1).any())
    outside = whole - _overlap(box, sheet)
    return sum(_overlap(box, other) for other in taken) + outside + 0.3 * whole * crossed


def _overlap(one: Box, other: Box) -> float:
    sides = np.minimum(one[1], other[1]) - np.maximum(one[0], other[0])
    return float(sides[0] * sides[1]) if (sides > 0).all() else 0.0
