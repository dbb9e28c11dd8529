"""The simulated motion of a stone against the measured one, a line per model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import pandas as pd
from matplotlib.figure import Figure

from curlshot.data.results import Hit
from curlshot.report.figures.parts import (
    LABELS,
    WIDTH,
    OnAxes,
    draw_measured,
    hits_of,
    legend_below,
    line,
    panels,
    rows_of,
    set_height,
    short,
    time_axis,
    title,
)
from curlshot.report.style import BLACK, model_lines, plain_text, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist


def comparison_figure(
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    stone: str,
    collisions: Sequence[Hit] = (),
    on: OnAxes = None,
) -> Figure:
    """One stone's simulated x and y, a line per model, against the measured ones.

    Bands are two standard deviations either side: grey of the measurement, coloured of a
    simulation that has them.

    Parameters
    ----------
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame
        Sampled simulation of each model: ``stone, t, x, y`` and, if known, ``sd_x, sd_y``.
    stone : str
        Which stone.
    collisions : sequence of Hit
        All hits of the shot, in order.
    on : sequence of Axes, optional
        Where to draw, two panels; a figure of its own without.
    """
    rows = rows_of(tracks, stone)
    lines = model_lines(simulations)
    with styled():
        figure, grid = panels(on, WIDTH, 4.4, 2, sharex=True)
        axes = grid[:, 0]
        first, last = (None, None) if on is None else axes
        for ax, column in zip(axes, ("x", "y"), strict=True):
            t, values, sd, seen = rows[["t", column, f"sd_{column}", "seen"]].to_numpy(float).T
            draw_measured(ax, t, values, sd, seen)
            for model, table in simulations.items():
                simulated = rows_of(table, stone)
                simulated = simulated[simulated["t"].between(rows["t"].min(), rows["t"].max())]
                colour, dash = lines[model]
                t, values = simulated[["t", column]].to_numpy(float).T
                if f"sd_{column}" in simulated:
                    sd = simulated[f"sd_{column}"].to_numpy(float)
                    ax.fill_between(
                        t, values - 2 * sd, values + 2 * sd, color=colour, alpha=0.15, lw=0
                    )
                ax.plot(t, values, color=colour, linestyle=dash, lw=1.6, zorder=4)
            ax.set_ylabel(LABELS[column])
            set_height(ax)
        own = [(rank, c.t) for rank, c in hits_of(collisions, stone)]
        time_axis(axes, own, rows["t"].to_numpy(float))
        figure.align_ylabels(axes)
        title(figure, f"Stone {short(stone, 40)}: simulated and measured", first)
        handles: list[Artist] = [line("measured (± 2 sd)", color=BLACK)]
        handles += [
            line(plain_text(model), color=colour, linestyle=dash, lw=1.6)
            for model, (colour, dash) in lines.items()
        ]
        legend_below(figure, handles, last)
    return figure
