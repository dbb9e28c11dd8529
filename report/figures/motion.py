"""One stone against time: place and speed, angle and spin; all stones' speeds in one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from curlshot.data.results import Glide, Hit, MeasuredState
from curlshot.data.sheet import GRAVITY, STONE
from curlshot.report.figures.parts import (
    LABELS,
    MOST_ENTRIES,
    WIDTH,
    Array,
    Hits,
    OnAxes,
    broken,
    draw_measured,
    hits_of,
    legend_below,
    legend_beside,
    line,
    panels,
    rows_of,
    said,
    set_height,
    short,
    speeds,
    time_axis,
    title,
)
from curlshot.report.numbers import plus_minus
from curlshot.report.style import AFTER, BEFORE, GREEN, stone_colours, styled
from curlshot.report.tables import magnitude, moving_stones

_TANGENT = 0.4  # s of fitted velocity drawn on either side of a hit, at most
_STILL = 1e-3  # m/s; slower is at rest
_RATES = {
    "x": ("vx", "$v_x$ (m/s)"),
    "y": ("vy", "$v_y$ (m/s)"),
    "theta": ("omega", "ω (rad/s)"),
}


def motion_figure(
    tracks: pd.DataFrame,
    stone: str,
    collisions: Sequence[Hit],
    glides: Sequence[Glide] = (),
    on: OnAxes = None,
) -> Figure:
    """One stone's x, y and speed against time, with the velocities fitted at each hit.

    The line is the smoothed track (dotted where no frame showed the stone), the band two
    standard deviations either side. Straight pieces have the slope of the velocity just before
    and just after a hit; in the panel of the speed they are those that the friction of each
    glide gives. The legends say the numbers.

    Parameters
    ----------
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    stone : str
        Which stone.
    collisions : sequence of Hit
        All hits of the shot, in order; those of this stone are marked, by their rank.
    glides : sequence of Glide
        With their friction; those of this stone are drawn.
    on : sequence of Axes, optional
        Where to draw, three panels; a figure of its own without.
    """
    rows, hits = rows_of(tracks, stone), hits_of(collisions, stone)
    own = [g for g in glides if g.stone == stone and g.friction is not None]
    with styled():
        figure, axes = _panels(on, 3, max(2 * len(hits), len(own)))
        for ax, column in zip(axes, ("x", "y"), strict=False):
            t, values, sd, seen = rows[["t", column, f"sd_{column}", "seen"]].to_numpy(float).T
            draw_measured(ax, t, values, sd, seen)
            _draw_rates(ax, rows, stone, column, hits)
            ax.set_ylabel(LABELS[column])
            set_height(ax)
        speed, sd = speeds(rows)
        t, seen = rows[["t", "seen"]].to_numpy(float).T
        draw_measured(axes[2], t, speed, sd, seen, [c.t for _, c in hits])
        _draw_glides(axes[2], t, speed, stone, own, hits)
        axes[2].set_ylabel(LABELS["speed"])
        set_height(axes[2], bottom=0.0)
        time_axis(axes, [(rank, c.t) for rank, c in hits], t)
        figure.align_ylabels(axes)
        title(figure, f"Stone {short(stone, 40)}: motion", None if on is None else axes[0])
    return figure


def spin_figure(
    tracks: pd.DataFrame, stone: str, collisions: Sequence[Hit], on: OnAxes = None
) -> Figure:
    """One stone's angle and spin against time, with the spins fitted at each hit.

    Drawn as `motion_figure`; the spins at the hits are points with bars of two standard
    errors. Nothing is drawn of what was not seen.

    Parameters
    ----------
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    stone : str
        Which stone.
    collisions : sequence of Hit
        All hits of the shot, in order; those of this stone are marked, by their rank.
    on : sequence of Axes, optional
        Where to draw, two panels; a figure of its own without.
    """
    rows, hits = rows_of(tracks, stone), hits_of(collisions, stone)
    with styled():
        figure, axes = _panels(on, 2, 2 * len(hits))
        for ax, column, cuts in zip(axes, ("theta", "omega"), ((), hits), strict=True):
            t, values, sd, seen = rows[["t", column, f"sd_{column}", "seen"]].to_numpy(float).T
            draw_measured(ax, t, values, sd, seen, [c.t for _, c in cuts])
            ax.set_ylabel(LABELS[column])
        _draw_rates(axes[0], rows, stone, "theta", hits)
        _draw_spins(axes[1], stone, hits)
        set_height(axes[0], 0.1)
        set_height(axes[1], 0.1)
        time_axis(axes, [(rank, c.t) for rank, c in hits], rows["t"].to_numpy(float))
        figure.align_ylabels(axes)
        title(figure, f"Stone {short(stone, 40)}: angle and spin", None if on is None else axes[0])
    return figure


def speed_figure(
    tracks: pd.DataFrame,
    collisions: Sequence[Hit] = (),
    radius: float = STONE.radius,
    on: OnAxes = None,
) -> Figure:
    """Speed of every stone that moved against time, with bands of two standard deviations."""
    stones = moving_stones(tracks, collisions, radius)
    colours = stone_colours(tracks["stone"].unique())
    with styled():
        figure, grid = panels(on, WIDTH, 3.0)
        ax = grid[0, 0]
        given = None if on is None else ax
        for stone in stones:
            rows = rows_of(tracks, stone)
            speed, sd = speeds(rows)
            cuts = [c.t for c in collisions if stone in c.stones]
            t, speed, sd = broken(rows["t"].to_numpy(float), speed, sd, cuts=cuts)
            colour = colours[stone]
            ax.fill_between(
                t, np.maximum(speed - 2 * sd, 0), speed + 2 * sd, color=colour, alpha=0.2, lw=0
            )
            ax.plot(t, speed, color=colour, label=f"stone {short(stone)}")
        ax.set_ylabel(LABELS["speed"])
        set_height(ax, bottom=0.0)
        time_axis([ax], [(k, c.t) for k, c in enumerate(collisions, 1)], tracks["t"].to_numpy())
        title(figure, "Speed", given)
        if stones:
            legend_below(figure, ax.get_legend_handles_labels()[0], given)
    return figure


def _panels(on: OnAxes, count: int, entries: int) -> tuple[Figure, list[Axes]]:
    """Panels above each other, each with room for a legend of so many entries beside it."""
    height = count * max(1.45, 0.19 * min(entries, MOST_ENTRIES) + 0.5) + 0.55
    figure, grid = panels(on, WIDTH, height, count, sharex=True)
    return figure, list(grid[:, 0])


def _sides(stone: str, hits: Hits) -> list[tuple[str, str, Hit, MeasuredState, float]]:
    """Each known state of a stone at its hits: label, colour, hit, state, end of its validity."""
    times = [c.t for _, c in hits]
    out = []
    for index, (rank, hit) in enumerate(hits):
        earlier = times[index - 1] if index else -np.inf
        later = times[index + 1] if index + 1 < len(times) else np.inf
        if stone in hit.before:
            out.append((f"before {rank}", BEFORE, hit, hit.before[stone], earlier))
        if stone in hit.after:
            out.append((f"after {rank}", AFTER, hit, hit.after[stone], later))
    return out


def _draw_rates(ax: Axes, rows: pd.DataFrame, stone: str, column: str, hits: Hits) -> None:
    """Straight pieces with the fitted rates, and a legend beside the panel that says them."""
    rate, head = _RATES[column]
    t, values = rows[["t", column]].to_numpy(float).T
    length = min(_TANGENT, 0.15 * float(t[-1] - t[0]))
    handles = []
    for label, colour, hit, state, end in _sides(stone, hits):
        value = getattr(state, rate)
        if value is None:
            continue
        # The angle has no place in the hit's state: it is read off the track.
        place = float(np.interp(hit.t, t, values) if column == "theta" else getattr(state, column))
        reach = min(abs(end - hit.t), length) * (1 if end > hit.t else -1)
        piece = Line2D(
            [hit.t, hit.t + reach],
            [place, place + value * reach],
            color=colour,
            lw=2.6,
            alpha=0.85,
            zorder=5,
            solid_capstyle="butt",
        )
        ax.add_line(piece)
        rest = bool(np.hypot(state.vx, state.vy) < _STILL) and abs(value) < _STILL
        text = said(value, getattr(state, f"sd_{rate}", None), rest)
        handles.append(line(f"{label}: {text}", color=colour, lw=2.6))
    legend_beside(ax, handles, head)


def _draw_glides(
    ax: Axes, t: Array, speed: Array, stone: str, glides: Sequence[Glide], hits: Hits
) -> None:
    """Speeds as the friction of each glide gives them, through the speed at its middle."""
    handles = []
    for glide in glides:
        inside = (t >= glide.t0) & (t <= glide.t1) & np.isfinite(speed) & (speed > _STILL)
        if not inside.any() or glide.friction is None:
            continue
        slowing = GRAVITY * glide.friction
        level = float(np.mean(speed[inside] + slowing * t[inside]))
        stop = level / slowing if slowing > 0 else np.inf
        ends = np.array([t[inside][0], min(t[inside][-1], stop)])
        ax.plot(ends, level - slowing * ends, color=GREEN, lw=2.6, alpha=0.7, zorder=4)
        label = plus_minus(glide.friction, glide.stderr)
        handles.append(line(f"{ends[0]:.1f}–{ends[1]:.1f} s: {label}", color=GREEN, lw=2.6))
    for _, colour, hit, state, _ in _sides(stone, hits):
        sd = getattr(state, "sd_vx", None), getattr(state, "sd_vy", None)
        value, error = magnitude(*np.array([state.vx, state.vy, *(s or 0.0 for s in sd)], float))
        _draw_point(ax, hit.t, float(value), float(error), colour)
    legend_beside(ax, handles, "μ of the glides")


def _draw_spins(ax: Axes, stone: str, hits: Hits) -> None:
    for _, colour, hit, state, _ in _sides(stone, hits):
        if state.omega is not None:
            _draw_point(ax, hit.t, state.omega, getattr(state, "sd_omega", None) or 0.0, colour)


def _draw_point(ax: Axes, t: float, value: float, sd: float, colour: str) -> None:
    ax.errorbar(t, value, 2 * sd, color=colour, fmt="o", ms=3.5, capsize=2, lw=1.2, zorder=6)
