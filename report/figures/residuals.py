"""What the fitted shot leaves of the detections."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from curlshot.data.results import Hit, TrackResidual
from curlshot.report.figures.parts import (
    WIDTH,
    Array,
    OnAxes,
    legend_below,
    line,
    panels,
    short,
    time_axis,
    title,
)
from curlshot.report.style import BLACK, GREY, PALE, stone_colours, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist

_FARTHEST = 5.0
"""Residual, in standard deviations, up to which the histogram goes."""

_MANY = 500
"""Detections from which on their dots are small."""

_BAND = 0.6
"""Opacity of the band of the stated errors."""

_TOP = 0.97
"""Height, of the axes, of bars over what the fit of the whole shot left out."""

_MOST_NAMED = 12
"""Stones that the legend names at most."""


def residuals_figure(
    residuals: pd.DataFrame,
    collisions: Sequence[Hit] = (),
    misfits: Sequence[TrackResidual] = (),
    on: OnAxes = None,
) -> Figure:
    """Sighted less smoothed places against time, and how they are distributed.

    Left, in mm, with a band of twice the median standard deviation that was claimed, and carets
    at the edge for what lies beyond; right, in standard deviations, against the normal
    distribution that they should follow.

    Parameters
    ----------
    residuals : DataFrame
        ``stone, t, dx, dy, sd_x, sd_y``, m and s, as `curlshot.report.tables.residual_table` makes
        it.
    collisions : sequence of Hit
        All hits of the shot, in order.
    misfits : sequence of TrackResidual
        Of the fit of the whole shot; bars along the top show what it left out.
    on : sequence of Axes, optional
        Where to draw, two by two panels; a figure of its own without.
    """
    stones = sorted(str(name) for name in residuals["stone"].unique())
    colours = stone_colours(stones)
    left_out = [one for one in misfits if one.downweighted and one.stone in colours]
    with styled():
        figure, grid = panels(on, WIDTH, 4.2, 2, 2, sharex="col", width_ratios=[3, 1])
        first, last = (None, None) if on is None else grid[:, 0]
        for row, axis in zip(grid, "xy", strict=True):
            off, sd = residuals[[f"d{axis}", f"sd_{axis}"]].to_numpy(float).T
            _draw_times(row[0], residuals, 1000 * off, 1000 * float(np.median(sd)), colours)
            for one in left_out:
                row[0].plot(
                    [one.t0, one.t1], [_TOP, _TOP], color=colours[one.stone], lw=4,
                    solid_capstyle="butt", transform=row[0].get_xaxis_transform(),
                )  # fmt: skip
            row[0].set_ylabel(f"Δ${axis}$ (mm)")
            _draw_histogram(row[1], off / sd)
        grid[1, 1].set_xlabel("in sd")
        time_axis(
            list(grid[:, 0]),
            [(rank, c.t) for rank, c in enumerate(collisions, 1)],
            residuals["t"].to_numpy(float),
        )
        figure.align_ylabels(grid[:, 0])
        title(figure, "Residuals: detections minus smoothed places", first)
        handles: list[Artist] = [
            line(f"stone {short(name)}", color=colours[name], marker="o", ms=3, ls="none")
            for name in stones[:_MOST_NAMED]
        ]
        handles += [
            line("± 2 sd, as estimated", color=PALE, alpha=_BAND, lw=6),
            line("outside the plot", color=BLACK, marker=6, ms=4, ls="none"),
            line("normal distribution", color=BLACK),
        ]
        if left_out:
            handles.append(line("down-weighted in the shot fit", color=PALE, lw=4))
        legend_below(figure, handles, last)
    return figure


def _draw_times(
    ax: Axes, residuals: pd.DataFrame, off: Array, sd: float, colours: dict[str, str]
) -> None:
    ax.axhspan(-2 * sd, 2 * sd, color=PALE, alpha=_BAND, lw=0, zorder=1)
    ax.axhline(0, color=GREY, lw=0.8, zorder=2)
    size = 2.5 if len(residuals) > _MANY else 4.5
    names, t = residuals["stone"].astype(str).to_numpy(), residuals["t"].to_numpy(float)
    for name, colour in colours.items():
        own = names == name
        ax.plot(
            t[own], off[own], ".", color=colour, ms=size, alpha=0.7, mew=0, zorder=3,
            rasterized=True,
        )  # fmt: skip
    # A few wild detections shall not squeeze all the others: they are marks at the edge.
    reach = 1.5 * max(float(np.quantile(np.abs(off), 0.98)), 2 * sd)
    for sign, mark in ((1, 6), (-1, 7)):  # carets with their tips at the value, up and down
        wild = sign * off > reach
        ax.plot(
            t[wild], np.full(wild.sum(), sign * reach), marker=mark, color=BLACK, ls="none", ms=4
        )
    ax.set_ylim(-reach, reach)


def _draw_histogram(ax: Axes, scaled: Array) -> None:
    kept = np.clip(scaled[np.isfinite(scaled)], -_FARTHEST, _FARTHEST)
    ax.hist(kept, bins=np.linspace(-_FARTHEST, _FARTHEST, 31).tolist(), density=True, color=PALE)
    x = np.linspace(-_FARTHEST, _FARTHEST, 101)
    ax.plot(x, np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi), color=BLACK, lw=1.2)
    ax.set_yticks([])
    ax.spines["left"].set_visible(False)
    ax.grid(False)
    share = float(np.mean(np.abs(kept) < 2)) if len(kept) else np.nan
    ax.set_title(f"{100 * share:.0f} % within 2 sd", fontsize=8, fontweight="normal", loc="center")
