"""The sheet from above: house, paths, hits, last places and how well they are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse

from curlshot.data.results import Hit
from curlshot.data.sheet import SHEET, STONE, House
from curlshot.physics.simulator.simulation import HitEvent
from curlshot.report.figures.labels import name_stones
from curlshot.report.figures.parts import (
    WIDTH,
    Array,
    OnAxes,
    legend_below,
    line,
    panels,
    rows_of,
    title,
)
from curlshot.report.style import (
    BLACK,
    GREY,
    RING_FILLS,
    model_lines,
    plain_text,
    stone_colours,
    styled,
)
from curlshot.report.tables import last_speed, moving_stones, play

if TYPE_CHECKING:
    from matplotlib.artist import Artist

_TALLEST = 7.4
"""Height of the sheet in the figure at most, inches."""

_NARROWEST = 2.2
"""Height of the sheet in the figure over its width, at most."""

_ENLARGED = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Factors by which an ellipse of uncertainty may be drawn larger than it is."""


def plan_figure(
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame] | None = None,
    collisions: Sequence[Hit] = (),
    *,
    house: House | None,
    radius: float = STONE.radius,
    on: OnAxes = None,
) -> Figure:
    """Draw the sheet from above: house, measured and simulated paths, hits, last places.

    The shaded ellipses at the last places are two standard deviations, enlarged by a factor
    that the legend gives, for they would be no more than a dot. An arrow shows where a stone goes
    on that was last seen under way; its simulations end at that time too.

    Parameters
    ----------
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame, optional
        Sampled simulation of each model; their last places are drawn as empty circles, of stones
        that were last seen under way those at that time.
    collisions : sequence of Hit
        The hits, a cross where the stones touched.
    house : House or None
        The rings to draw; None where the scene has no house.
    radius : float
        Radius of the stones, m.
    on : Axes, optional
        Where to draw; a figure of its own without.
    """
    stones = sorted(str(name) for name in tracks["stone"].unique())
    under_way = [name for name in stones if last_speed(rows_of(tracks, name))]
    ends = tracks[tracks["stone"].isin(under_way)].groupby("stone")["t"].max()
    simulations = {
        model: table[table["t"] <= table["stone"].map(ends).fillna(np.inf)]
        for model, table in (simulations or {}).items()
    }
    moved = moving_stones(tracks, collisions, radius)
    # Where nothing moves there is no path to simulate.
    colours, lines = stone_colours(stones), model_lines(simulations if moved else {})
    last = {name: _last_place(rows_of(tracks, name)) for name in stones}
    low, high = _extent(tracks, simulations, moved, last, house, radius)
    rows_below = 1 + (4 + len(lines)) // 3
    with styled():
        figure, ax, scale = new_sheet(low, high, rows_below, on)
        given = None if on is None else ax
        if house is not None:
            draw_house(ax, house, low, high, play(tracks, collisions, radius))
        for model, table in simulations.items():
            for stone in moved:
                path = rows_of(table, stone)
                if not path.empty:
                    _draw_simulated(ax, path, colours[stone], lines[model][1], radius)
        for stone in moved:
            x, y = _way(rows_of(tracks, stone), stone, collisions)
            ax.plot(x, y, color=colours[stone], lw=2, alpha=0.85, zorder=3, solid_capstyle="round")
        for stone in stones:
            ax.add_patch(
                Circle(pair(last[stone]), radius, fc="white", ec=colours[stone], lw=1.6, zorder=4)
            )
        for stone in under_way:
            _draw_arrow(ax, rows_of(tracks, stone), colours[stone], radius)
        factor = _draw_ellipses(ax, tracks, last, colours, radius)
        for collision in collisions:
            ax.plot(*contact_place(collision, radius), "x", color=BLACK, ms=6, mew=1.6, zorder=6)
        name_stones(ax, last, colours, radius, scale)
        title(figure, "Plan view", given)
        handles = _handles(bool(moved), lines, bool(collisions), bool(under_way), factor)
        if handles:
            legend_below(figure, handles, given)
    return figure


def _handles(
    moved: bool,
    lines: Mapping[str, tuple[Any, Any]],
    hits: bool,
    under_way: bool,
    factor: int | None,
) -> list[Artist]:
    """Entries of the legend, of what is drawn."""
    handles: list[Artist] = [line("measured", color=GREY, lw=2)] if moved else []
    handles += [
        line(plain_text(model), color=GREY, linestyle=dash, lw=1.1)
        for model, (_, dash) in lines.items()
    ]
    if hits:
        handles.append(line("hit", color=BLACK, marker="x", ls="none", mew=1.6))
    if under_way:
        shaft: dict[str, Any] = {"marker": r"$\rightarrow$", "ls": "none", "ms": 11, "mew": 0}
        handles.append(line("last detected, moving", color=GREY, **shaft))
    if factor:
        by = "" if factor == 1 else f", {factor} × enlarged"
        shade: dict[str, Any] = {"color": GREY, "marker": "o", "ls": "none", "alpha": 0.5}
        handles.append(line(f"± 2 sd{by}", mew=0, ms=7, **shade))
    return handles


def new_sheet(
    low: Array, high: Array, rows_below: int, on: OnAxes = None
) -> tuple[Figure, Axes, float]:
    """Give a figure of the ice between two corners, m, over so many rows of legend, and inches a m.

    Axes that are given keep their size, and the ice is fitted in.
    For use within `curlshot.report.style.styled`.
    """
    scale = min((WIDTH - 0.75) / (high[0] - low[0]), _TALLEST / (high[1] - low[1]))
    height = scale * float(high[1] - low[1]) + 0.85 + 0.2 * rows_below
    figure, grid = panels(on, WIDTH, height)
    ax = grid[0, 0]
    if on is not None:
        box = ax.get_window_extent()
        scale = min(np.array([box.width, box.height]) / figure.dpi / (high - low))
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    ax.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
    ax.grid(False)
    return figure, ax, float(scale)


def thickened(low: Array, high: Array) -> tuple[Array, Array]:
    """Move two corners apart where what is between them would be a strip."""
    width, height = high - low
    thin = max(height / _NARROWEST - width, 0) / 2, max(0.35 * width - height, 0) / 2
    return low - thin, high + thin


def draw_house(ax: Axes, house: House, low: Array, high: Array, play: int = -1) -> None:
    """Draw rings and lines where they lie between two corners, m; stones come down y, or up."""
    radii = (house.twelve_foot, house.eight_foot, house.four_foot, house.button)
    for ring, fill in zip(radii, RING_FILLS, strict=True):
        ax.add_patch(Circle((0, 0), ring, facecolor=fill, edgecolor="#b8c4d0", lw=0.6, zorder=0))
    painted: dict[str, Any] = {"color": "#b8c4d0", "lw": 0.7, "zorder": 0.5}
    centre = np.sort([play * house.twelve_foot, -play * SHEET.far_tee])
    ax.plot([0, 0], [max(low[1], centre[0]), min(high[1], centre[1])], **painted)
    ax.plot([low[0], high[0]], [0, 0], **painted)
    for y in (play * SHEET.back_line, -play * SHEET.hog_line):
        if low[1] < y < high[1]:
            ax.plot([low[0], high[0]], [y, y], **painted)


def _draw_simulated(ax: Axes, path: pd.DataFrame, colour: str, dash: Any, radius: float) -> None:
    ax.plot(path["x"], path["y"], color=colour, linestyle=dash, lw=1.1)
    end = Circle(pair(_last_place(path)), radius, fill=False, ec=colour, lw=0.9)
    end.set_linestyle(dash)
    ax.add_patch(end)


def _draw_arrow(ax: Axes, track: pd.DataFrame, colour: str, radius: float) -> None:
    """Draw where a stone goes on from its last place, out of its rim."""
    velocities = track[["vx", "vy"]].to_numpy(float)
    velocity = velocities[np.hypot(*velocities.T) > 0][-1]
    along = velocity / np.hypot(*velocity)
    tail = _last_place(track) + 1.1 * radius * along
    arrow = {"arrowstyle": "->", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", pair(tail + 0.8 * radius * along), pair(tail), arrowprops=arrow, zorder=4)


def _draw_ellipses(
    ax: Axes,
    tracks: pd.DataFrame,
    last: Mapping[str, Array],
    colours: Mapping[str, str],
    radius: float,
) -> int | None:
    """Shade two standard deviations about the last places; return by how much enlarged."""
    ends = tracks.sort_values("t").groupby("stone").last()
    spread = {name: 2 * ends.loc[name, ["sd_x", "sd_y"]].to_numpy(float) for name in last}
    known = {name: sd for name, sd in spread.items() if np.isfinite(sd).all() and sd.all()}
    if not known:
        return None
    sizes = [float(sd.max()) for sd in known.values()]
    room = min(0.9 * radius / float(np.median(sizes)), 2 * radius / max(sizes))
    factor = max((f for f in _ENLARGED if f <= room), default=1)
    for name, sd in known.items():
        wide, tall = pair(2 * factor * sd)
        ax.add_patch(
            Ellipse(pair(last[name]), wide, tall, fc=colours[name], alpha=0.25, lw=0, zorder=5)
        )
    return factor


def _way(track: pd.DataFrame, stone: str, collisions: Sequence[Hit]) -> Array:
    """Path of a stone, x and y: where it was seen, and where it was as it hit another."""
    hits = [(hit.t, hit.before[stone]) for hit in collisions if stone in hit.before]
    t, x, y = track[["t", "x", "y"]].to_numpy(float).T
    at = np.searchsorted(t, [when for when, _ in hits])
    return np.array(
        [
            np.insert(x, at, [state.x for _, state in hits]),
            np.insert(y, at, [state.y for _, state in hits]),
        ]
    )


def contact_place(collision: Hit | HitEvent, radius: float) -> Array:
    """Where two stones touched, m; NaN where neither's place is told."""
    first, second = collision.stones
    n = np.array(collision.normal)
    places = []
    for name, sign in ((first, 1), (second, -1)):
        if name in collision.before:
            state = collision.before[name]
            places.append(np.array([state.x, state.y]) + sign * radius * n)
    return np.mean(places, axis=0) if places else np.full(2, np.nan)


def pair(place: Array) -> tuple[float, float]:
    """Give a place as matplotlib takes it."""
    return float(place[0]), float(place[1])


def _last_place(rows: pd.DataFrame) -> Array:
    return np.asarray(rows[["x", "y"]].to_numpy(float)[-1], float)


def _extent(
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    moved: Sequence[str],
    last: Mapping[str, Array],
    house: House | None,
    radius: float,
) -> tuple[Array, Array]:
    """Corners of the part of the sheet that is shown, m.

    All that matters is in it: last places, the house, the paths, but of those on a sheet only as
    much as keeps the picture from becoming a strip. A simulation gone astray may leave it.
    """
    edge = 2 * radius
    ends = np.array(list(last.values()))
    core = [ends - edge, ends + edge] if len(ends) else [np.array([[-edge] * 2, [edge] * 2])]
    if house is not None:
        core.append(np.array([[-1, -1], [1, 1]]) * (house.twelve_foot + 0.5 * edge))
    low, high = np.concatenate(core).min(axis=0), np.concatenate(core).max(axis=0)
    paths = tracks.loc[tracks["stone"].isin(list(moved)), ["x", "y"]].to_numpy(float)
    if len(paths):
        low = np.minimum(low, paths.min(axis=0) - edge)
        high = np.maximum(high, paths.max(axis=0) + edge)
    for table in simulations.values():
        for stone in moved:
            rows = rows_of(table, stone)
            if not rows.empty and np.isfinite(_last_place(rows)).all():
                end = np.clip(_last_place(rows), low - 2 * edge, high + 2 * edge)
                low, high = np.minimum(low, end - edge), np.maximum(high, end + edge)
    if house is not None:
        # Of a long delivery the end is enough.
        room = _NARROWEST * float(high[0] - low[0])
        core_low = min(float(ends[:, 1].min()), -house.twelve_foot) - edge
        core_high = max(float(ends[:, 1].max()), house.twelve_foot) + edge
        high[1] = max(core_high, min(high[1], core_low + room))
        low[1] = min(core_low, max(low[1], high[1] - room))
    return thickened(low, high)
