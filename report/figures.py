"""The figures of a shot: each one function on the tables, returning a matplotlib `Figure`.

All lengths in m, times in s, angles in rad. The tables are `data.tracks.TRACK_COLUMNS` for
what was measured and ``stone, frame, t, x, y, theta, vx, vy, omega`` for what was simulated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike, NDArray

from data.results import Collision, StoneState
from data.sheet import SHEET, STONE, House
from report.numbers import fixed
from report.style import (
    AFTER,
    BEFORE,
    BLACK,
    GREY,
    PALE,
    RING_FILLS,
    model_lines,
    new_figure,
    plain_text,
    stone_colours,
    styled,
)
from report.tables import moving_stones

if TYPE_CHECKING:
    from matplotlib.artist import Artist

Array = NDArray[np.float64]

WIDTH = 5.6
"""Width of a figure, inches: its text stays readable on a phone."""

_TANGENT = 0.4  # s of fitted velocity drawn on either side of a hit, at most
_UNITS = {"x": "m", "y": "m", "theta": "rad"}
_RATES = {
    "x": ("vx", "$v_x$", "m/s"),
    "y": ("vy", "$v_y$", "m/s"),
    "theta": ("omega", "ω", "rad/s"),
}
_LABELS = {"x": "$x$ (m)", "y": "$y$ (m)", "theta": "angle (rad)"}


def motion_figure(tracks: pd.DataFrame, stone: str, collisions: Sequence[Collision]) -> Figure:
    """One stone's x, y and angle against time, with the velocities fitted at each hit.

    The line is the smoothed track (dotted where no frame showed the stone), the band two
    standard deviations either side. Straight pieces have the slope of the velocity just
    before and just after a hit; the legend says it. Without any angle there is no panel for it.

    Parameters
    ----------
    tracks : DataFrame
        With `data.tracks.TRACK_COLUMNS`.
    stone : str
        Which stone.
    collisions : sequence of Collision
        All hits of the shot, in order; those of this stone are marked, by their rank.
    """
    rows = _rows(tracks, stone)
    hits = [(rank, c) for rank, c in enumerate(collisions, 1) if stone in c.stones]
    columns = [name for name in ("x", "y", "theta") if bool(rows[name].notna().any())]
    entries = 2 * len(hits) + 1
    with styled():
        figure = new_figure(WIDTH, len(columns) * max(1.45, 0.19 * entries + 0.35) + 0.55)
        axes = figure.subplots(len(columns), 1, sharex=True, squeeze=False)[:, 0]
        for ax, column in zip(axes, columns, strict=True):
            _draw_track(ax, rows, column)
            _draw_fits(ax, rows, stone, column, hits)
            ax.set_ylabel(_LABELS[column])
        _time_axis(axes, [(rank, c.t) for rank, c in hits], rows["t"].to_numpy(float))
        figure.align_ylabels(axes)
        figure.suptitle(f"Stone {_short(stone, 40)}: motion", x=0.01, ha="left", **_TITLE)
    return figure


def comparison_figure(
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame],
    stone: str,
    collisions: Sequence[Collision] = (),
) -> Figure:
    """One stone's simulated x and y, a line per model, against the measured ones."""
    rows = _rows(tracks, stone)
    lines = model_lines(simulations)
    with styled():
        figure = new_figure(WIDTH, 4.2)
        axes = figure.subplots(2, 1, sharex=True)
        for ax, column in zip(axes, ("x", "y"), strict=True):
            _draw_track(ax, rows, column)
            for model, table in simulations.items():
                simulated = _rows(table, stone)
                colour, dash = lines[model]
                t, values = simulated["t"].to_numpy(float), simulated[column].to_numpy(float)
                ax.plot(t, values, color=colour, linestyle=dash, lw=1.6, zorder=4)
            ax.set_ylabel(_LABELS[column])
        hits = [(k, c.t) for k, c in enumerate(collisions, 1) if stone in c.stones]
        _time_axis(axes, hits, rows["t"].to_numpy(float))
        figure.align_ylabels(axes)
        figure.suptitle(
            f"Stone {_short(stone, 40)}: simulated and measured", x=0.01, ha="left", **_TITLE
        )
        handles: list[Artist] = [Line2D([], [], color=BLACK, label="measured (± 2 sd)")]
        handles += [
            Line2D([], [], color=colour, linestyle=dash, lw=1.6, label=plain_text(model))
            for model, (colour, dash) in lines.items()
        ]
        _legend_below(figure, handles)
    return figure


def speed_figure(
    tracks: pd.DataFrame, collisions: Sequence[Collision] = (), radius: float = STONE.radius
) -> Figure:
    """Speed of every stone that moved against time, with bands of two standard deviations."""
    stones = moving_stones(tracks, collisions, radius)
    colours = stone_colours(tracks["stone"].unique())
    with styled():
        figure = new_figure(WIDTH, 3.0)
        ax = figure.subplots()
        for stone in stones:
            rows = _rows(tracks, stone)
            t, vx, vy, sx, sy = rows[["t", "vx", "vy", "sd_vx", "sd_vy"]].to_numpy(float).T
            speed = np.hypot(vx, vy)
            slow = speed < 1e-9
            along = np.hypot(vx * sx, vy * sy) / np.where(slow, 1.0, speed)
            sd = np.where(slow, np.maximum(sx, sy), along)
            cuts = [c.t for c in collisions if stone in c.stones]
            t, speed, sd = _broken(t, speed, sd, cuts=cuts)
            colour = colours[stone]
            ax.fill_between(
                t, np.maximum(speed - 2 * sd, 0), speed + 2 * sd, color=colour, alpha=0.2, lw=0
            )
            ax.plot(t, speed, color=colour, label=f"stone {_short(stone)}")
        ax.set_ylabel("speed (m/s)")
        ax.set_ylim(bottom=0)
        _time_axis([ax], [(k, c.t) for k, c in enumerate(collisions, 1)], tracks["t"].to_numpy())
        figure.suptitle("Speed", x=0.01, ha="left", **_TITLE)
        if stones:
            _legend_below(figure, ax.get_legend_handles_labels()[0])
    return figure


def hit_figure(collision: Collision, rank: int = 1, radius: float = STONE.radius) -> Figure:
    """One hit in its normal and tangential axes, with the velocities before and after it.

    n points from the first stone to the second, t is n turned a quarter to the left; the
    components are those of the centres' velocities.
    """
    n = np.array(collision.normal, float)
    t = np.array([-n[1], n[0]])
    first, second = collision.stones
    # Side by side at contact, whatever gap the clock left between them: the contact is the origin.
    centres = {first: -radius * n, second: radius * n}
    states = {"before": collision.before, "after": collision.after}
    arrows = {
        (when, name): _velocity(side[name])
        for when, side in states.items()
        for name in collision.stones
        if name in side and np.isfinite(_velocity(side[name])).all()
    }
    longest = max((float(np.hypot(*v)) for v in arrows.values()), default=0.0) or 1.0
    scale = 2.2 * radius / longest
    with styled():
        figure = new_figure(WIDTH, 3.6)
        ax, text = figure.subplots(1, 2, width_ratios=[1.5, 1])
        reach = 4.1 * radius
        for direction, label in ((n, "n"), (t, "t")):
            ends = np.outer([-0.8 * reach, 0.8 * reach], direction)
            ax.plot(*ends.T, color=GREY, lw=0.8, zorder=1)
            ax.annotate(
                "",
                0.86 * reach * direction,
                0.7 * reach * direction,
                arrowprops={"arrowstyle": "-|>", "color": GREY, "lw": 0.8},
            )
            ax.text(*(0.95 * reach * direction), label, style="italic", ha="center", va="center")
        for name in collision.stones:
            rim = Circle(_pair(centres[name]), radius, facecolor="white", edgecolor=BLACK, lw=1.2)
            ax.add_patch(rim)
            ax.plot(*centres[name], ".", color=BLACK, ms=3, zorder=6)
            # The arrow of the velocity before comes in from behind, the one after goes out.
            busy = [
                -v if when == "before" else v for (when, who), v in arrows.items() if who == name
            ]
            place = centres[name] + 0.62 * radius * _free_direction([*busy, n, -n])
            ax.text(
                *place,
                _symbols(collision.stones)[name],
                ha="center",
                va="center",
                weight="bold",
                zorder=6,
            )
        for (when, name), v in arrows.items():
            if np.hypot(*v) * scale < 0.05 * radius:
                continue
            start, end = (-scale * v, 0 * v) if when == "before" else (0 * v, scale * v)
            ax.annotate(
                "",
                centres[name] + end,
                centres[name] + start,
                zorder=5,
                arrowprops={
                    "arrowstyle": "-|>",
                    "mutation_scale": 11,
                    "color": BEFORE if when == "before" else AFTER,
                    "lw": 1.8,
                    "shrinkA": 0,
                    "shrinkB": 0,
                },
            )
        ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
        ax.grid(False)
        ax.spines[:].set_visible(False)
        _components(text, collision, n, t)
        figure.suptitle(
            f"Hit {rank}: {_short(first)} on {_short(second)} at {fixed(collision.t)} s",
            x=0.01,
            ha="left",
            **_TITLE,
        )
    return figure


def plan_figure(
    tracks: pd.DataFrame,
    simulations: Mapping[str, pd.DataFrame] | None = None,
    collisions: Sequence[Collision] = (),
    *,
    house: House | None,
    radius: float = STONE.radius,
) -> Figure:
    """Draw the sheet from above: house, measured and simulated paths, hits, last places.

    Parameters
    ----------
    tracks : DataFrame
        With `data.tracks.TRACK_COLUMNS`.
    simulations : mapping of str to DataFrame, optional
        Sampled simulation of each model; their last places are drawn as empty circles.
    collisions : sequence of Collision
        The hits, a cross where the stones touched.
    house : House or None
        The rings to draw; None where the scene has no house.
    radius : float
        Radius of the stones, m.
    """
    simulations = simulations or {}
    stones = sorted(str(name) for name in tracks["stone"].unique())
    moved = moving_stones(tracks, collisions, radius)
    colours, lines = stone_colours(stones), model_lines(simulations)
    last = {name: _last_place(_rows(tracks, name)) for name in stones}
    low, high = _extent(tracks, simulations, moved, last, house, radius)
    rows_below = 1 + (2 + len(lines)) // 3
    scale = min((WIDTH - 0.75) / (high[0] - low[0]), 7.4 / (high[1] - low[1]))
    with styled():
        figure = new_figure(WIDTH, scale * (high[1] - low[1]) + 0.85 + 0.2 * rows_below)
        ax = figure.subplots()
        if house is not None:
            draw_house(ax, house, low, high)
        for model, table in simulations.items():
            for stone in moved:
                path = _rows(table, stone)
                if path.empty:
                    continue
                dash = lines[model][1]
                ax.plot(path["x"], path["y"], color=colours[stone], linestyle=dash, lw=1.1)
                end = Circle(
                    _pair(_last_place(path)), radius, fill=False, ec=colours[stone], lw=0.9
                )
                end.set_linestyle(dash)
                ax.add_patch(end)
        for stone in moved:
            x, y = _rows(tracks, stone)[["x", "y"]].to_numpy(float).T
            ax.plot(x, y, color=colours[stone], lw=2, alpha=0.85, zorder=3, solid_capstyle="round")
        for stone in stones:
            ax.add_patch(
                Circle(_pair(last[stone]), radius, fc="white", ec=colours[stone], lw=1.6, zorder=4)
            )
        for collision in collisions:
            ax.plot(*_contact(collision, radius), "x", color=BLACK, ms=6, mew=1.6, zorder=6)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        drawn = [np.asarray(line.get_xydata(), float) for line in ax.lines]
        paths = np.concatenate([np.empty((0, 2)), *drawn])
        _name_stones(ax, last, colours, paths, radius, scale)
        ax.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
        ax.grid(False)
        figure.suptitle("Plan view", x=0.01, ha="left", **_TITLE)
        handles: list[Artist] = [Line2D([], [], color=GREY, lw=2, label="measured")]
        handles += [
            Line2D([], [], color=GREY, linestyle=dash, lw=1.1, label=plain_text(model))
            for model, (_, dash) in lines.items()
        ]
        if collisions:
            handles.append(Line2D([], [], color=BLACK, marker="x", ls="none", mew=1.6, label="hit"))
        if moved:
            _legend_below(figure, handles)
    return figure


# ---------------------------------------------------------------------------- the parts

_TITLE: dict[str, Any] = {"fontsize": 10, "fontweight": "bold"}


def _rows(table: pd.DataFrame, stone: str) -> pd.DataFrame:
    return table[table["stone"] == stone].sort_values("t")


def _broken(t: Array, *columns: Array, cuts: Sequence[float] = ()) -> list[Array]:
    """Insert NaN rows where a line must not run on: in long gaps and at the cuts."""
    if len(t) < 2:
        return [t, *columns]
    steps = np.diff(t)
    gaps = np.flatnonzero(steps > 5 * np.median(steps)) + 1
    at = np.unique(np.concatenate([gaps, np.searchsorted(t, np.asarray(cuts, float))]))
    at = at[(at > 0) & (at < len(t))].astype(int)
    return [np.insert(np.asarray(c, float), at, np.nan) for c in (t, *columns)]


def _draw_track(ax: Axes, rows: pd.DataFrame, column: str) -> None:
    t, values, sd, seen = rows[["t", column, f"sd_{column}", "seen"]].to_numpy(float).T
    t, values, sd, seen = _broken(t, values, sd, seen)
    ax.fill_between(t, values - 2 * sd, values + 2 * sd, color=PALE, lw=0, zorder=1)
    ax.plot(t, np.where(seen == 1, values, np.nan), color=BLACK, zorder=3)
    if (seen == 0).any():
        ax.plot(t, values, color=BLACK, lw=1, linestyle=":", zorder=2)
    if len(t) == 1:
        ax.plot(t, values, "o", color=BLACK, ms=4)


def _draw_fits(
    ax: Axes,
    rows: pd.DataFrame,
    stone: str,
    column: str,
    hits: Sequence[tuple[int, Collision]],
) -> None:
    """Straight pieces with the fitted rates, and a legend beside the panel that says them."""
    rate, symbol, unit = _RATES[column]
    t, values = rows[["t", column]].to_numpy(float).T
    times = [c.t for _, c in hits]
    length = min(_TANGENT, 0.15 * float(t[-1] - t[0]))
    handles = []
    for index, (rank, collision) in enumerate(hits):
        before_end = times[index - 1] if index else -np.inf
        after_end = times[index + 1] if index + 1 < len(times) else np.inf
        # The angle has no place in the hit's state: it is read off the track.
        state = collision.before.get(stone)
        place = (
            float(np.interp(collision.t, t, values))
            if column == "theta" or state is None
            else float(getattr(state, column))
        )
        for when, side, colour, end in (
            ("before", collision.before, BEFORE, max(before_end, collision.t - length)),
            ("after", collision.after, AFTER, min(after_end, collision.t + length)),
        ):
            value = None if stone not in side else getattr(side[stone], rate)
            if value is None:
                continue
            ax.plot(
                [collision.t, end],
                [place, place + value * (end - collision.t)],
                color=colour,
                lw=2.6,
                alpha=0.85,
                zorder=5,
                solid_capstyle="butt",
            )
            label = f"{when} {rank}: {fixed(value)}"
            handles.append(Line2D([], [], color=colour, lw=2.6, label=label))
    if handles:
        ax.legend(
            handles=handles,
            title=f"{symbol} ({unit})",
            loc="upper left",
            bbox_to_anchor=(1.0, 1.05),
            alignment="left",
            handlelength=1.2,
            borderaxespad=0.3,
            labelspacing=0.3,
        )


def _time_axis(
    axes: Sequence[Axes] | NDArray[Any], hits: Sequence[tuple[int, float]], t: ArrayLike
) -> None:
    """Share one time axis; the hits are lines with their ranks on top, staggered where close."""
    times = np.asarray(t, float)
    first, last = float(times.min()), float(times.max())
    margin = 0.02 * (last - first) or 0.5
    axes[0].set_xlim(first - margin, last + margin)
    axes[-1].set_xlabel("time (s)")
    levels: list[float] = []  # time of the last label on each level
    for rank, when in hits:
        room = when - 0.045 * (last - first + 2 * margin)
        level = next((k for k, taken in enumerate(levels) if taken < room), len(levels))
        levels[level : level + 1] = [when]
        for ax in axes:
            ax.axvline(when, color=GREY, lw=0.8, linestyle=(0, (3, 2)), zorder=2)
        axes[0].annotate(
            f"{rank}",
            (when, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 2 + 10 * level),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8,
            color=GREY,
        )


def _velocity(state: StoneState) -> Array:
    return np.array([state.vx, state.vy], float)


def _contact(collision: Collision, radius: float) -> Array:
    first, second = collision.stones
    n = np.array(collision.normal)
    places = []
    for name, sign in ((first, 1), (second, -1)):
        if name in collision.before:
            state = collision.before[name]
            places.append(np.array([state.x, state.y]) + sign * radius * n)
    return np.mean(places, axis=0) if places else np.full(2, np.nan)


def _free_direction(busy: Sequence[Array]) -> Array:
    """Of 24 directions the one farthest, in angle, from all the busy ones."""
    angles = np.arange(24) * np.pi / 12
    candidates = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    lengths = [float(np.hypot(*v)) for v in busy]
    units = np.array([v / length for v, length in zip(busy, lengths, strict=True) if length > 1e-6])
    nearest = (candidates @ units.T).max(axis=1)
    return np.asarray(candidates[int(np.argmin(nearest))], float)


def _short(name: str, letters: int = 16) -> str:
    return plain_text(name if len(name) <= letters else name[: letters - 1] + "…")


def _symbols(names: Sequence[str]) -> dict[str, str]:
    """Give what fits into a stone: its name, or 1 and 2 where a name is longer than that."""
    if all(len(name) <= 2 for name in names):
        return {name: plain_text(name) for name in names}
    return {name: str(rank) for rank, name in enumerate(names, 1)}


def _legend_below(figure: Figure, handles: Sequence[Artist]) -> None:
    """Put a legend under the figure in as many columns as its width has room for."""
    widths = [0.5 + 0.066 * len(str(handle.get_label())) for handle in handles]
    columns = len(handles) if sum(widths) < WIDTH - 0.2 else int((WIDTH - 0.2) / max(widths))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=max(1, min(len(handles), columns)),
        columnspacing=1.2,
    )


def _components(ax: Axes, collision: Collision, n: Array, t: Array) -> None:
    """Write the n and t components as a small table in the figure."""
    symbols = _symbols(collision.stones)
    ax.set_axis_off()
    ax.set(xlim=(0, 1), ylim=(0, 1))
    y = 0.93
    kwargs: dict[str, Any] = {"va": "center", "fontsize": 8.5}
    for column, label in ((0.66, "$v_n$"), (1.0, "$v_t$")):
        ax.text(column, y, f"{label} (m/s)", ha="right", **kwargs)
    for name in collision.stones:
        y -= 0.13
        title = _short(name) if symbols[name] == name else f"{symbols[name]}: {_short(name)}"
        ax.text(0, y, title, weight="bold", **kwargs)
        for when, side, colour in (
            ("before", collision.before, BEFORE),
            ("after", collision.after, AFTER),
        ):
            y -= 0.09
            ax.text(0.02, y, when, color=colour, **kwargs)
            if name not in side:
                continue
            v = _velocity(side[name])
            for column, axis in ((0.66, n), (1.0, t)):
                ax.text(column, y, fixed(float(v @ axis)), color=colour, ha="right", **kwargs)


def _pair(place: Array) -> tuple[float, float]:
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

    All that matters is in it: last places, the house, and as much of the paths as keeps the
    picture from becoming a strip. A simulation gone astray may leave the picture.
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
            rows = _rows(table, stone)
            if not rows.empty and np.isfinite(_last_place(rows)).all():
                end = np.clip(_last_place(rows), low - 2 * edge, high + 2 * edge)
                low, high = np.minimum(low, end - edge), np.maximum(high, end + edge)
    width, height = high - low
    if height > 2.2 * width:
        core_low, core_high = ends.min(axis=0)[1] - edge, ends.max(axis=0)[1] + edge
        if house is not None:
            core_low = min(core_low, -house.twelve_foot - edge)
            core_high = max(core_high, house.twelve_foot + edge)
        high[1] = max(core_high, min(high[1], core_low + 2.2 * width))
        low[1] = min(core_low, max(low[1], high[1] - 2.2 * width))
    short = max(0.35 * (high[0] - low[0]) - (high[1] - low[1]), 0) / 2
    margin = np.array([0, short])
    return low - margin, high + margin


def draw_house(ax: Axes, house: House, low: Array, high: Array) -> None:
    """Draw rings and lines where they lie between two corners, m."""
    radii = (house.twelve_foot, house.eight_foot, house.four_foot, house.button)
    for ring, fill in zip(radii, RING_FILLS, strict=True):
        ax.add_patch(Circle((0, 0), ring, facecolor=fill, edgecolor="#b8c4d0", lw=0.6, zorder=0))
    line: dict[str, Any] = {"color": "#b8c4d0", "lw": 0.7, "zorder": 0.5}
    ax.plot([0, 0], [max(low[1], -house.twelve_foot), min(high[1], SHEET.far_tee)], **line)
    ax.plot([low[0], high[0]], [0, 0], **line)
    for y in (-SHEET.back_line, SHEET.hog_line):
        if low[1] < y < high[1]:
            ax.plot([low[0], high[0]], [y, y], **line)


def _name_stones(
    ax: Axes,
    last: Mapping[str, Array],
    colours: Mapping[str, str],
    lines: Array,
    radius: float,
    scale: float,
) -> None:
    """Names inside the stones where they fit, else beside them where there is room."""
    inside = 72 * scale * radius  # the stone's radius in points
    size = min(9.0, max(6.5, inside))
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    low, high = np.array([left, bottom]), np.array([right, top])
    em = size / 72 / scale  # height of the letters in metres
    taken = [(place - radius, place + radius) for place in last.values()]
    for name, place in last.items():
        text: dict[str, Any] = {
            "color": colours[name], "weight": "bold", "fontsize": size, "zorder": 7,
            "va": "center", "ha": "center",
            "path_effects": [withStroke(linewidth=2, foreground="white")],
        }  # fmt: skip
        label = _short(name)
        half = np.array([0.36 * em * len(label), 0.6 * em])
        if np.hypot(*half) < radius:
            ax.text(place[0], place[1], label, **text)
            continue
        boxes = []
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            centre = place + np.array([dx, dy]) * (radius + half + 0.2 * em)
            boxes.append((centre - half, centre + half))
        box = min(boxes, key=lambda b: _cost(b, taken, lines, low, high))
        taken.append(box)
        x, y = (box[0] + box[1]) / 2
        ax.text(x, y, label, **text)


def _cost(
    box: tuple[Array, Array],
    taken: Sequence[tuple[Array, Array]],
    lines: Array,
    low: Array,
    high: Array,
) -> float:
    """Area of a label's box that is taken or outside the picture, and a little for lines in it."""
    whole = float(np.prod(box[1] - box[0]))
    crossed = bool(((lines > box[0]) & (lines < box[1])).all(axis=1).any())
    outside = whole - _overlap(box, (low, high))
    return sum(_overlap(box, other) for other in taken) + outside + 0.3 * whole * crossed


def _overlap(one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
    sides = np.minimum(one[1], other[1]) - np.maximum(one[0], other[0])
    return float(sides[0] * sides[1]) if (sides > 0).all() else 0.0
