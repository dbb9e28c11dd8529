"""A simulated shot on the sheet from above: where its stones began, went and came to rest."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from curlshot.data.sheet import STONE, House
from curlshot.physics.simulator.simulation import HitEvent
from curlshot.report.figures.labels import name_stones
from curlshot.report.figures.parts import Array, OnAxes, legend_below, line, rows_of, title
from curlshot.report.figures.plan import contact_place, draw_house, new_sheet, pair, thickened
from curlshot.report.numbers import count, fixed
from curlshot.report.style import BLACK, GREY, plain_text, stone_colours, styled

FAR = 6.4
"""How far from the tee, or from where a stone began, a place still is in view, m."""


def simulated_figure(
    table: pd.DataFrame,
    hits: Sequence[HitEvent] = (),
    *,
    gone: Collection[str] = (),
    house: House | None,
    radius: float = STONE.radius,
    play: int = -1,
    on: OnAxes = None,
) -> Figure:
    """Draw a simulated shot from above.

    Stones that end far away, or leave the sheet, are in the legend.

    Parameters
    ----------
    table : DataFrame
        ``stone, t, x, y`` of the shot until all is at rest.
    hits : sequence of HitEvent
        A cross where the stones touched.
    gone : collection of str
        Stones that leave the sheet where their paths end.
    house : House or None
        The rings to draw; None where places do not count from a tee.
    radius : float
        Radius of the stones, m.
    play : int
        1 where stones are thrown up y, -1 where down: behind the tee is the back line.
    on : Axes, optional
        Where to draw; a figure of its own without.
    """
    paths = {
        str(name): rows_of(table, str(name))[["x", "y"]].to_numpy(float)
        for name in sorted(table["stone"].unique())
    }
    starts, ends = ({name: path[at] for name, path in paths.items()} for at in (0, -1))
    centre = np.zeros(2) if house is not None else np.median([*starts.values()], axis=0)
    shown = {name: end for name, end in ends.items() if _near(end, centre)}
    low, high = _extent([*starts.values(), *shown.values()], centre, house, radius)
    far = [name for name, end in ends.items() if not ((low < end) & (end < high)).all()]
    colours = stone_colours(paths)
    with styled():
        figure, ax, scale = new_sheet(low, high, 1 + (2 + len(far)) // 2, on)
        given = None if on is None else ax
        if house is not None:
            draw_house(ax, house, low, high, play)
        for name, path in paths.items():
            ax.add_patch(Circle(pair(path[0]), radius, fc="none", ec=colours[name], lw=0.8, ls=":"))
            ax.plot(*path.T, color=colours[name], lw=1.6, alpha=0.85, zorder=3)
        for name, end in shown.items():
            rim: dict[str, Any] = {"ls": "--" if name in gone else "-", "ec": colours[name]}
            ax.add_patch(Circle(pair(end), radius, fc="white", lw=1.6, zorder=4, **rim))
        for hit in hits:
            ax.plot(*contact_place(hit, radius), "x", color=BLACK, ms=6, mew=1.6, zorder=6)
        name_stones(ax, shown, colours, radius, scale)
        title(figure, f"Simulated: {count(len(paths), 'stone')}, {count(len(hits), 'hit')}", given)
        handles = [line("start", color=GREY, marker="o", mfc="none", ls="none", ms=8)]
        if hits:
            handles.append(line("hit", color=BLACK, marker="x", ls="none", mew=1.6))
        handles += [
            line(_told(plain_text(name), end, name in far, name in gone), color=colours[name])
            for name, end in ends.items()
            if name in far or name in gone
        ]
        legend_below(figure, handles, given)
    return figure


def _told(name: str, end: Array, far: bool, gone: bool) -> str:
    """Say what the picture does not show of the end of a stone's path."""
    place = f"({fixed(end[0], 1)}, {fixed(end[1], 1)}) m"
    if gone:
        return f"{name} leaves the sheet{f' at {place}' if far else ''}"
    return f"{name} continues to {place}"


def _near(place: Array, centre: Array) -> bool:
    return bool((np.abs(place - centre) < FAR).all())


def _extent(
    places: Sequence[Array], centre: Array, house: House | None, radius: float
) -> tuple[Array, Array]:
    """Corners of what is shown, m: house, first and last places, but no strip of a long throw."""
    near = np.array([place for place in places if _near(place, centre)] or [centre])
    low, high = near.min(axis=0) - 3 * radius, near.max(axis=0) + 3 * radius
    if house is not None:
        low = np.minimum(low, -house.twelve_foot - radius)
        high = np.maximum(high, house.twelve_foot + radius)
    return thickened(low, high)
