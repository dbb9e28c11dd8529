"""One hit in its normal and tangential axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from curlshot.data.results import Hit, MeasuredState
from curlshot.data.sheet import STONE
from curlshot.report.figures.parts import WIDTH, Array, OnAxes, panels, said, short, symbols, title
from curlshot.report.numbers import DASH, plus_minus
from curlshot.report.style import AFTER, BEFORE, BLACK, GREY, styled
from curlshot.report.tables import in_axes

_COLUMNS = ((0.47, "$v_n$ (m/s)"), (0.74, "$v_t$ (m/s)"), (1.0, "ω (rad/s)"))


def hit_figure(
    collision: Hit, rank: int = 1, radius: float = STONE.radius, on: OnAxes = None
) -> Figure:
    """One hit in its normal and tangential axes, with the velocities before and after it.

    n points from the first stone to the second, t is n turned a quarter to the left; the
    components are those of the centres' velocities, each with its standard error.

    Parameters
    ----------
    collision : Hit
        The hit.
    rank : int
        Its rank among the hits of the shot, for the title.
    radius : float
        Radius of the stones, m.
    on : sequence of Axes, optional
        Where to draw, one for the stones and one for the numbers; a figure of its own without.
    """
    first, second = collision.stones
    with styled():
        figure, grid = panels(on, WIDTH, 5.2, 2, height_ratios=[1.75, 1])
        stones, table = grid[:, 0]
        _draw_stones(stones, collision, radius)
        _write_components(table, collision)
        time = plus_minus(collision.t, collision.stderr_t)
        what = f"Hit {rank}: {short(first)} on {short(second)} at {time} s"
        title(figure, what, None if on is None else stones)
    return figure


def _draw_stones(ax: Axes, collision: Hit, radius: float) -> None:
    n = np.array(collision.normal, float)
    t = np.array([-n[1], n[0]])
    first, second = collision.stones
    # Side by side at contact, whatever gap the clock left between them: the contact is the origin.
    centres = {first: -radius * n, second: radius * n}
    arrows = _arrows(collision)
    longest = max((float(np.hypot(*v)) for v in arrows.values()), default=0.0) or 1.0
    scale = 2.2 * radius / longest
    reach = 4.1 * radius
    for direction, label in ((n, "n"), (t, "t")):
        ends = np.outer([-0.8 * reach, 0.8 * reach], direction)
        ax.plot(*ends.T, color=GREY, lw=0.8, zorder=1)
        head, tail = (tuple(part * reach * direction) for part in (0.86, 0.7))
        _arrow(ax, tail, head, color=GREY, lw=0.8)
        x, y = 0.95 * reach * direction
        ax.text(x, y, label, style="italic", ha="center", va="center")
    for name, label in symbols(collision.stones).items():
        x, y = centres[name]
        ax.add_patch(Circle((x, y), radius, facecolor="white", edgecolor=BLACK, lw=1.2))
        ax.plot(x, y, ".", color=BLACK, ms=3, zorder=6)
        # The arrow of the velocity before comes in from behind, the one after goes out.
        busy = [-v if when == "before" else v for (when, who), v in arrows.items() if who == name]
        x, y = centres[name] + 0.62 * radius * _free_direction([*busy, n, -n])
        ax.text(x, y, label, ha="center", va="center", weight="bold", zorder=6)
    for (when, name), v in arrows.items():
        if np.hypot(*v) * scale < 0.05 * radius:
            continue
        start, end = (-scale * v, 0 * v) if when == "before" else (0 * v, scale * v)
        colour = BEFORE if when == "before" else AFTER
        style = {"color": colour, "lw": 1.8, "mutation_scale": 11, "shrinkA": 0, "shrinkB": 0}
        _arrow(ax, tuple(centres[name] + start), tuple(centres[name] + end), **style)
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
    ax.grid(False)
    ax.spines[:].set_visible(False)


def _arrows(collision: Hit) -> dict[tuple[str, str], Array]:
    """Known velocities by when and stone, m/s."""
    out = {}
    for when, side in (("before", collision.before), ("after", collision.after)):
        for name in collision.stones:
            if name in side:
                velocity = np.array([side[name].vx, side[name].vy], float)
                if np.isfinite(velocity).all():
                    out[when, name] = velocity
    return out


def _arrow(ax: Axes, tail: tuple[float, ...], head: tuple[float, ...], **style: Any) -> None:
    ax.annotate(
        "", (head[0], head[1]), (tail[0], tail[1]), zorder=5,
        arrowprops={"arrowstyle": "-|>", **style},
    )  # fmt: skip


def _free_direction(busy: Sequence[Array]) -> Array:
    """Of 24 directions the one farthest, in angle, from all the busy ones."""
    angles = np.arange(24) * np.pi / 12
    candidates = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    lengths = [float(np.hypot(*v)) for v in busy]
    units = np.array([v / length for v, length in zip(busy, lengths, strict=True) if length > 1e-6])
    nearest = (candidates @ units.T).max(axis=1)
    return np.asarray(candidates[int(np.argmin(nearest))], float)


def _write_components(ax: Axes, collision: Hit) -> None:
    """Write the n and t components and the spins as a small table, and e below it."""
    ax.set_axis_off()
    ax.set(xlim=(0, 1), ylim=(0, 1))
    words: dict[str, Any] = {"va": "center", "fontsize": 8.5}
    for x, head in _COLUMNS:
        ax.text(x, 0.97, head, ha="right", **words)
    y = 0.97
    for name, symbol in symbols(collision.stones).items():
        label = symbol if len(name) <= 2 else f"{symbol}: {short(name, 12)}"
        for when, side, colour in (
            ("before", collision.before, BEFORE),
            ("after", collision.after, AFTER),
        ):
            y -= 0.17
            if when == "before":
                ax.text(0, y, label, weight="bold", **words)
            ax.text(0.25, y, when, color=colour, ha="right", **words)
            cells = _cells(side.get(name), collision.normal)
            for (x, _), text in zip(_COLUMNS, cells, strict=True):
                ax.text(x, y, text, color=colour, ha="right", **words)
    laws = [f"e = {plus_minus(collision.restitution, collision.stderr)}"]
    if collision.stone_friction is not None:
        rub = plus_minus(collision.stone_friction, collision.stderr_stone_friction)
        laws.append(f"friction between the stones {rub}")
    ax.text(0, y - 0.2, ",  ".join(laws), **words)


def _cells(state: MeasuredState | None, normal: tuple[float, float]) -> tuple[str, str, str]:
    if state is None:
        return DASH, DASH, DASH
    (vn, sd_n), (vt, sd_t) = in_axes(state, normal)
    rest = float(np.hypot(state.vx, state.vy)) < 1e-3
    spin = DASH if state.omega is None else said(state.omega, state.sd_omega)
    if rest:
        return "at rest", "", ""
    return said(vn, sd_n), said(vt, sd_t), spin
