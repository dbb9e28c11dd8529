"""A simulated shot, and where it ends if it is thrown many times, as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from numpy.typing import NDArray

from curlshot.data.files import write_text
from curlshot.data.sheet import HOUSE, STONE
from curlshot.data.tracks import write_table
from curlshot.physics.prediction.start import Start
from curlshot.physics.simulator.simulation import Simulation
from curlshot.report.figures import draw_house, name_stones, simulated_figure
from curlshot.report.figures.parts import legend_below, short
from curlshot.report.numbers import MINUS, count
from curlshot.report.style import (
    BLACK,
    GREY,
    PNG_DPI,
    new_figure,
    plain_text,
    stone_colours,
    styled,
)

Array = NDArray[np.float64]

CELL = 0.05
"""Width of a cell of the heat map, m."""
SHARE = 0.98
"""Share of the outcomes that the picture shows at least, per axis and end, unless far off."""
FARTHEST, ANYWHERE = 6.4, 20.0
"""Most that the picture shows along and across, m from its centre, with a house and without."""
FEW = 50
"""Throws; fewer are dots, for a map of them would show how it is smoothed."""
BESIDE = 1.6
"""Inches of the picture's width beside the sheet."""
MOST_DOTS = 1000
"""Dots of one stone."""
WIDEST = 80
"""Letters of a line of the title."""


def write_simulated(
    folder: Path, start: Start, simulation: Simulation, table: pd.DataFrame
) -> None:
    """Write a simulated shot, sampled as `table`, as ``simulation.csv`` and ``plan.png``."""
    write_table(table, folder / "simulation.csv")
    house = HOUSE if start.house else None
    figure = simulated_figure(
        table,
        simulation.hits,
        gone=simulation.gone,
        house=house,
        radius=start.shot.radius,
        play=_play(start),
    )
    figure.savefig(folder / "plan.png", dpi=PNG_DPI)


def write_odds(folder: Path, start: Start, outcomes: pd.DataFrame, odds: Mapping[str, Any]) -> None:
    """Write where a shot thrown many times ends, as a table, in sum and as a picture.

    Parameters
    ----------
    folder : Path
        For ``outcomes.csv``, ``whatif.json`` and ``spread.png``.
    start : Start
        The shot.
    outcomes : DataFrame
        As `curlshot.physics.prediction.what_if.sample` gives them.
    odds : mapping
        The same in sum.
    """
    write_table(outcomes, folder / "outcomes.csv")
    write_text(folder / "whatif.json", json.dumps(odds, indent=1, ensure_ascii=False) + "\n")
    thrown = f"{odds['thrown']} thrown {count(odds['samples'], 'time')}"
    figure = spread_figure(
        outcomes,
        {stone.name: (stone.x, stone.y) for stone in start.shot.stones},
        odds["thrown"],
        fill(", ".join([thrown, *described(odds["changes"])]), WIDEST),
        start.shot.radius,
        house=start.house,
        play=_play(start),
    )
    figure.savefig(folder / "spread.png", dpi=PNG_DPI)


def described(changes: Mapping[str, Any]) -> list[str]:
    """Say in a few words each what was changed of a shot; `changes` as in ``whatif.json``."""
    signs = {"restitution": ("e", ""), "friction": ("μ", ""), "speed": ("speed", " m/s"),
             "spin": ("spin", " rad/s")}  # fmt: skip
    words = []
    for name, change in changes.items():
        if name == "aim_offset":
            side = "left" if change > 0 else "right"
            words.append(f"aimed {_plain(abs(change))} m to its {side}")
            continue
        sign, unit = signs[name]
        amount = change if isinstance(change, Mapping) else {"value": change, "relative": False}
        text = _plain(amount["value"])
        words.append(f"{sign} × {text}" if amount["relative"] else f"{sign} = {text}{unit}")
    return words


def _plain(value: float) -> str:
    return f"{value:g}".replace("-", MINUS)


def _play(start: Start) -> int:
    """Tell whether the thrown stone goes up y, 1, or down, -1."""
    return 1 if start.shot.stones[start.thrown].vy > 0 else -1


def spread_figure(
    outcomes: pd.DataFrame,
    before: Mapping[str, tuple[float, float]],
    thrown: str,
    title: str,
    radius: float = STONE.radius,
    *,
    house: bool = True,
    play: int = -1,
) -> Figure:
    """Draw where the stones come to rest, the thrown one as a heat map, others as dots.

    Those that leave the sheet come to rest nowhere on it: they are counted beside the names.
    Few throws are dots, all of them.

    Parameters
    ----------
    outcomes : DataFrame
        ``sample, stone, x, y, hits, in_play`` as `curlshot.physics.prediction.what_if.sample` gives
        them.
    before : mapping of str to (float, float)
        Places of the stones before, m.
    thrown : str
        The thrown stone.
    title : str
        One line.
    radius : float
        Radius of the stones, m.
    house : bool
        Whether places count from the tee of a house.
    play : int
        1 where stones are thrown up y, -1 where down: behind the tee is the back line.
    """
    own = outcomes["stone"] == thrown
    # A stone that nothing touched lies where it lay.
    shown = outcomes[own | (outcomes["hits"] > 0)]
    places = {
        str(name): group.loc[group["in_play"] == 1, ["x", "y"]].to_numpy(float)
        for name, group in shown.groupby("stone", sort=True)
    }
    gone = {
        str(name): 1 - share for name, share in shown.groupby("stone")["in_play"].mean().items()
    }
    ends, throws = places.pop(thrown), int(own.sum())
    lying = {name: place for name, place in before.items() if name != thrown}
    low, high = _corners([ends, *places.values()], [*lying.values()], radius, house)
    colours = stone_colours(outcomes["stone"].unique())
    wide, tall = high - low
    width = 7.0
    with styled():
        figure = new_figure(width, min((width - BESIDE) * tall / wide + 1.3, 10.0))
        ax = figure.subplots()
        if house:
            draw_house(ax, HOUSE, low, high, play)
        label = f"where {short(thrown)} ends,\n% of throws on 10 cm × 10 cm"
        _draw_ends(ax, ends, throws, (low, high), radius, label)
        for name, struck in places.items():
            dots = struck[:MOST_DOTS]
            ax.plot(*dots.T, ".", color=colours[name], ms=2.5, alpha=0.6, mew=0, zorder=3)
        for name, place in lying.items():
            ax.add_patch(Circle(place, radius, fc="white", ec=colours[name], lw=1.4, zorder=4))
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        seen = {n: np.array(at) for n, at in lying.items() if _shows(low, high, np.array([at]))}
        name_stones(ax, seen, colours, radius, (width - BESIDE) / wide)
        ax.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
        ax.grid(False)
        figure.suptitle(plain_text(title), x=0.01, ha="left", fontsize=10, fontweight="bold")
        handles = _of_thrown(plain_text(thrown), len(ends), throws, gone[thrown])
        if _shows(low, high, np.array([*lying.values()]).reshape(-1, 2)):
            handles.append(_ring(GREY, "before the shot"))
        handles += [
            _dots(colours[name], f"{plain_text(name)} where hit{_gone(gone[name])}")
            for name, struck in places.items()
            if gone[name] > 0 or _shows(low, high, struck)
        ]
        legend_below(figure, handles)
    return figure


def _draw_ends(
    ax: Axes, ends: Array, throws: int, corners: tuple[Array, Array], radius: float, label: str
) -> None:
    """Draw where a stone ends that was thrown so many times, and its usual place."""
    if throws < FEW:
        ax.plot(*ends.T, ".", color=BLACK, ms=4, mew=0, zorder=7)
    elif len(ends):
        share, across, along = _density(ends, *corners, throws)
        heat = ax.pcolormesh(
            across, along, np.ma.masked_less(share, 0.01 * share.max()), cmap="viridis_r",
            alpha=0.75, lw=0, rasterized=True, zorder=2,
        )  # fmt: skip
        bar = ax.figure.colorbar(heat, ax=ax, shrink=0.6, pad=0.01)
        bar.set_label(label)
    if len(ends) > 1:
        middle = np.median(ends, axis=0)
        ring = Circle((middle[0], middle[1]), radius, fill=False, ec=BLACK, lw=1.4, zorder=6)
        ax.add_patch(ring)


def _of_thrown(name: str, ends: int, throws: int, gone: float) -> list[Artist]:
    """Say what is drawn of the thrown stone, which came to rest on the sheet `ends` times."""
    if not ends:
        return [Line2D([], [], ls="none", label=f"{name} always leaves the sheet")]
    handles: list[Artist] = []
    if throws < FEW:
        handles.append(_dots(BLACK, f"where {name} ends{_gone(gone)}"))
    if ends > 1:
        handles.append(_ring(BLACK, f"median of {name}{_gone(gone) if throws >= FEW else ''}"))
    return handles


def _dots(colour: str, label: str) -> Line2D:
    return Line2D([], [], color=colour, marker=".", ls="none", label=label)


def _ring(colour: str, label: str) -> Line2D:
    return Line2D([], [], mec=colour, marker="o", ls="none", mfc="none", label=label)


def _gone(share: float) -> str:
    """Say how often a stone leaves the sheet, if it does."""
    return f" ({share:.0%} off the sheet)" if share else ""


def _corners(
    ends: list[Array], lying: list[tuple[float, float]], radius: float, house: bool
) -> tuple[Array, Array]:
    """Corners of what is shown, m: the house, the stones and nearly all of the outcomes.

    Where there is none, or the thrown stone ends far from it, what is about its end instead.
    """
    middle = np.median(ends[0], axis=0) if len(ends[0]) else np.zeros(2)
    at_home = house and bool((np.abs(middle) < FARTHEST).all())
    centre = np.zeros(2) if at_home else middle
    reach = FARTHEST if house else ANYWHERE
    rim = radius + (HOUSE.twelve_foot if house else 0.0)
    parts = [np.array([[-rim, -rim], [rim, rim]]) + centre, np.array(lying).reshape(-1, 2)]
    near = [places[(np.abs(places - centre) < reach).all(axis=1)] for places in ends]
    parts += [np.quantile(places, [1 - SHARE, SHARE], axis=0) for places in near if len(places)]
    shown = np.clip(np.concatenate(parts), centre - reach, centre + reach)
    return shown.min(axis=0) - 2 * radius, shown.max(axis=0) + 2 * radius


def _shows(low: Array, high: Array, places: Array) -> bool:
    """Whether any of some places, shape (n, 2), lies between two corners."""
    return bool(((places > low) & (places < high)).all(axis=1).any())


def _density(ends: Array, low: Array, high: Array, throws: int) -> tuple[Array, Array, Array]:
    """Percentage of the throws on 0.1 m × 0.1 m about each cell, smoothed, and edges of cells."""
    from scipy.ndimage import convolve1d, gaussian_filter

    across, along = (np.arange(low[k], high[k] + CELL, CELL) for k in range(2))
    count = np.histogram2d(ends[:, 1], ends[:, 0], bins=(along, across))[0]
    sharpness = np.clip(4 * len(ends) ** (-1 / 3), 0.5, 4)  # fewer samples, a smoother map
    share = gaussian_filter(count, sharpness, mode="constant") / throws
    for axis in range(2):  # a cell and half of either next one are 0.1 m wide
        share = convolve1d(share, [0.5, 1, 0.5], axis=axis, mode="constant")
    return np.asarray(100 * share), across, along
