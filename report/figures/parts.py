"""What several figures share: rows of a stone, lines that break, the axis of time, legends."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from curlshot.data.errors import InputError
from curlshot.data.results import Hit
from curlshot.report.numbers import fixed, parts
from curlshot.report.style import BLACK, GREY, PALE, new_figure, plain_text
from curlshot.report.tables import magnitude

if TYPE_CHECKING:
    from matplotlib.artist import Artist

Array = NDArray[np.float64]

WIDTH = 6.0
"""Width of a figure, inches: its text stays readable on a phone."""

LABELS = {
    "x": "$x$ (m)",
    "y": "$y$ (m)",
    "speed": "speed (m/s)",
    "theta": "angle (rad)",
    "omega": "spin (rad/s)",
}
"""What stands at the axis of a column of the tracks."""

MOST_ENTRIES = 10
"""Entries of a legend beside a panel, at most."""

Hits = Sequence[tuple[int, Hit]]
"""Hits with their ranks."""


OnAxes = Axes | Sequence[Axes] | NDArray[Any] | None
"""What a figure is drawn on: axes of the caller, or a figure of its own."""


def panels(
    on: OnAxes, width: float, height: float, rows: int = 1, columns: int = 1, **layout: Any
) -> tuple[Figure, NDArray[Any]]:
    """Return a figure and its axes, shape (rows, columns): those given, or new ones.

    Raises
    ------
    InputError
        Where another number of axes is given.
    """
    if on is None:
        figure = new_figure(width, height)
        return figure, np.asarray(figure.subplots(rows, columns, squeeze=False, **layout))
    given = np.asarray(on, object).ravel()
    if given.size != rows * columns:
        raise InputError(f"ax: {given.size} axes given; this figure needs {rows * columns}")
    return cast(Figure, given[0].figure), given.reshape(rows, columns)


def title(figure: Figure, text: str, ax: Axes | None = None) -> None:
    """Set the one line above a figure, or above `ax`; the text is taken as it is."""
    if ax is not None:
        ax.set_title(text, loc="left", fontsize=10, fontweight="bold", pad=14)
        return
    figure.suptitle(text, x=0.01, ha="left", fontsize=10, fontweight="bold")


def rows_of(table: pd.DataFrame, stone: str) -> pd.DataFrame:
    """Rows of one stone in order of time."""
    return table[table["stone"] == stone].sort_values("t")


def hits_of(collisions: Sequence[Hit], stone: str) -> list[tuple[int, Hit]]:
    """Hits of one stone, each with its rank among all."""
    return [(rank, c) for rank, c in enumerate(collisions, 1) if stone in c.stones]


def speeds(rows: pd.DataFrame) -> tuple[Array, Array]:
    """Speed of each row and its standard deviation, m/s."""
    return magnitude(*rows[["vx", "vy", "sd_vx", "sd_vy"]].to_numpy(float).T)


def broken(t: Array, *columns: Array, cuts: Sequence[float] = ()) -> list[Array]:
    """Insert NaN rows where a line must not run on: in long gaps and at the cuts."""
    if len(t) < 2:
        return [t, *columns]
    steps = np.diff(t)
    gaps = np.flatnonzero(steps > 5 * np.median(steps)) + 1
    at = np.unique(np.concatenate([gaps, np.searchsorted(t, np.asarray(cuts, float))]))
    at = at[(at > 0) & (at < len(t))].astype(int)
    return [np.insert(np.asarray(c, float), at, np.nan) for c in (t, *columns)]


def draw_measured(
    ax: Axes, t: Array, values: Array, sd: Array, seen: Array, cuts: Sequence[float] = ()
) -> None:
    """Draw a measured quantity with its band of 2 sd, dotted where no frame showed the stone."""
    t, values, sd, seen = broken(t, values, sd, seen, cuts=cuts)
    ax.fill_between(t, values - 2 * sd, values + 2 * sd, color=PALE, lw=0, zorder=1)
    ax.plot(t, np.where(seen == 1, values, np.nan), color=BLACK, zorder=3)
    if (seen == 0).any():
        ax.plot(t, values, color=BLACK, lw=1, linestyle=":", zorder=2)
    if len(t) == 1:
        ax.plot(t, values, "o", color=BLACK, ms=4)


def set_height(ax: Axes, least: float = 0.0, bottom: float | None = None) -> None:
    """Choose the limits of y by the lines, and by the bands but where they are widest.

    Parameters
    ----------
    ax : Axes
        With the lines and bands that count drawn, and no other.
    least : float
        Height at least: noise shall not fill the panel.
    bottom : float, optional
        The lower limit, where it is given by the quantity.
    """
    ends = [np.asarray(item.get_ydata(), float) for item in ax.lines]
    for band in ax.collections:
        if isinstance(band, PolyCollection):
            paths = [np.asarray(path.vertices, float)[:, 1] for path in band.get_paths()]
            edges = np.concatenate([np.zeros(0), *paths])
            edges = edges[np.isfinite(edges)]
            ends.append(np.quantile(edges, [0.03, 0.97]) if len(edges) else edges)
    values = np.concatenate([np.zeros(0), *ends])
    values = values[np.isfinite(values)]
    if not len(values):
        return
    low, high = float(values.min()), float(values.max())
    room = max(1.1 * (high - low), least) or 1.0
    middle = (low + high) / 2
    ax.set_ylim(middle - room / 2 if bottom is None else bottom, middle + room / 2)


def time_axis(
    axes: Sequence[Axes] | NDArray[Any], hits: Sequence[tuple[int, float]], t: ArrayLike
) -> None:
    """Share one time axis; the hits are lines with their ranks on top, as one where close."""
    times = np.asarray(t, float)
    first, last = float(times.min()), float(times.max())
    margin = 0.02 * (last - first) or 0.5
    axes[0].set_xlim(first - margin, last + margin)
    axes[-1].set_xlabel("time (s)")
    for _, when in hits:
        for ax in axes:
            ax.axvline(when, color=GREY, lw=0.8, linestyle=(0, (3, 2)), zorder=2)
    for label, when in _joined(hits, 0.014 * (last - first + 2 * margin)):
        axes[0].annotate(
            label,
            (when, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 2),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8,
            color=GREY,
        )


def _joined(hits: Sequence[tuple[int, float]], letter: float) -> list[tuple[str, float]]:
    """Labels of hits and their times; those of which one would reach into the next become one."""
    groups: list[list[tuple[int, float]]] = [[hit] for hit in hits]
    while True:
        labels = [(_ranks([r for r, _ in g]), sum(t for _, t in g) / len(g)) for g in groups]
        for k, ((one, t), (two, later)) in enumerate(pairwise(labels)):
            if later - t < letter * (1 + (len(one) + len(two)) / 2):
                groups[k : k + 2] = [groups[k] + groups[k + 1]]
                break
        else:
            return labels


def _ranks(ranks: Sequence[int]) -> str:
    if len(ranks) > 2 and ranks[-1] - ranks[0] == len(ranks) - 1:
        return f"{ranks[0]}–{ranks[-1]}"
    return ", ".join(map(str, ranks))


def short(name: str, letters: int = 16) -> str:
    """Name of a stone as a figure has room for it."""
    return plain_text(name if len(name) <= letters else name[: letters - 1] + "…")


def symbols(names: Sequence[str]) -> dict[str, str]:
    """Give what fits into a stone: its name, or 1 and 2 where a name is longer than that."""
    if all(len(name) <= 2 for name in names):
        return {name: plain_text(name) for name in names}
    return {name: str(rank) for rank, name in enumerate(names, 1)}


def line(label: str, **style: Any) -> Line2D:
    """Return an entry of a legend."""
    return Line2D([], [], label=label, **style)


def legend_below(figure: Figure, handles: Sequence[Artist], ax: Axes | None = None) -> int:
    """Put a legend under the figure, or under `ax`, in columns; return the number of its rows."""
    widths = [0.5 + 0.066 * len(str(handle.get_label())) for handle in handles]
    own = figure.get_figwidth() if ax is None else ax.get_window_extent().width / figure.dpi
    room = float(own) - 0.2
    columns = len(handles) if sum(widths) < room else int(room / max(widths))
    columns = max(1, min(len(handles), columns))
    look: dict[str, Any] = {"handles": handles, "ncols": columns, "columnspacing": 1.2}
    if ax is None:
        figure.legend(loc="outside lower center", **look)
    else:  # the pad, in letters, leaves room for ticks and a label
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.5, **look)
    return -(-len(handles) // columns)


def legend_beside(ax: Axes, handles: Sequence[Artist], head: str) -> None:
    """Put a legend with a head to the right of one panel; of many entries the first ones."""
    if len(handles) > MOST_ENTRIES:
        more = len(handles) - MOST_ENTRIES + 1
        handles = [*handles[: MOST_ENTRIES - 1], line(f"and {more} more", ls="none")]
    if handles:
        ax.legend(
            handles=handles,
            title=head,
            loc="upper left",
            bbox_to_anchor=(1.0, 1.05),
            alignment="left",
            handlelength=1.2,
            borderaxespad=0.3,
            labelspacing=0.3,
        )


def said(value: float, stderr: float | None, rest: bool = False) -> str:
    """Write a value with its error as a figure has room for it; "at rest" for a stone that is."""
    if rest:
        return "at rest"
    first, second = parts(value, stderr)
    return fixed(value) if second is None else f"{first} ± {second}"
