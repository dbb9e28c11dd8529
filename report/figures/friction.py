"""Friction of the ice against speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from curlshot.data.results import Friction, Glide
from curlshot.data.sheet import GRAVITY
from curlshot.physics.ice import FCV1, IceLaw, Penner
from curlshot.physics.prediction.laws import law_of
from curlshot.report.figures.parts import (
    WIDTH,
    Array,
    OnAxes,
    legend_below,
    line,
    panels,
    rows_of,
    short,
    speeds,
    title,
)
from curlshot.report.numbers import plus_minus
from curlshot.report.style import BLACK, GREY, PALE, stone_colours, styled

if TYPE_CHECKING:
    from matplotlib.artist import Artist

MEASURED = (0.006, 0.016)
"""Friction of curling ice as measured by Li et al., 2022, Lubricants 10, 265."""

_LAWS: tuple[tuple[str, IceLaw, Any], ...] = (
    ("FCV1 (Uehara and Ito)", FCV1(), (0, (4, 2))),
    ("Penner", Penner(), (0, (1, 1.5))),
)

_SLOWEST = 0.05
"""Speed from which on a law is drawn, m/s: some have a pole at rest."""


FAINT = 0.35
"""How opaque glides are drawn that tell next to nothing."""


def friction_figure(
    glides: Sequence[Glide],
    friction: Friction,
    tracks: pd.DataFrame,
    *,
    curling: bool = True,
    on: OnAxes = None,
) -> Figure:
    """Friction of each glide over the speeds that it spans, and the law fitted to the shot.

    A bar across is the span of speeds, the one upright two standard errors either side; the
    band about the law is two of its value's. Glides that tell next to nothing are pale and leave
    the axis as it is: an arrow at its end stands for those beyond.

    Parameters
    ----------
    glides : sequence of Glide
        Each with its friction.
    friction : Friction
        Of the whole shot.
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`, for the speeds of the glides.
    curling : bool
        Whether these are stones on curling ice: then laws of the literature are shown too, and
        the range that was measured.
    on : Axes, optional
        Where to draw; a figure of its own without.
    """
    colours = stone_colours(tracks["stone"].unique())
    spans = [(glide, _span(glide, tracks)) for glide in glides]
    known = [(glide, span) for glide, span in spans if glide.friction is not None and span]
    fastest = max([1.0, *(1.1 * span[1] for _, span in known)])
    v = np.linspace(_SLOWEST, fastest, 200)
    handles: list[Artist] = []
    with styled():
        figure, grid = panels(on, WIDTH, 3.4)
        ax = grid[0, 0]
        given = None if on is None else ax
        if curling:
            ax.axhspan(*MEASURED, color=PALE, alpha=0.5, lw=0, zorder=0)
            # As pale as the range itself: the darker band is this shot's.
            handles.append(line("Li et al., measured", color=PALE, alpha=0.5, lw=6))
            for label, law, dash in _LAWS:
                ax.plot(v, _friction(law, v), color=GREY, lw=1.1, linestyle=dash, zorder=2)
                handles.append(line(label, color=GREY, lw=1.1, linestyle=dash))
        telling = [glide for glide, _ in known if _tells(glide, friction)]
        limits = _limits(telling, friction, curling)
        for glide, (slow, fast) in known:
            alpha = 1.0 if glide in telling else FAINT
            _draw_glide(ax, glide, slow, fast, colours[glide.stone], alpha, limits)
        for name in sorted({glide.stone for glide, _ in known}):
            handles.append(line(f"stone {short(name)}", color=colours[name], lw=2.2))
        if len(telling) < len(known):
            handles.append(line("uncertain (▴▾ beyond)", color=GREY, alpha=FAINT, lw=2.2))
        if friction.value is not None:
            mu = _friction(law_of(friction), v)
            error = 2 * (friction.stderr or 0.0)
            ax.fill_between(v, mu - error, mu + error, color=BLACK, alpha=0.12, lw=0, zorder=1)
            ax.plot(v, mu, color=BLACK, zorder=3)
            text = plus_minus(friction.value, friction.stderr)
            where = " at 1 m/s" if friction.law == "fit" else ""
            handles.insert(0, line(f"this shot: μ = {text}{where}", color=BLACK))
        ax.set(xlabel="speed (m/s)", ylabel="μ", xlim=(0, fastest))
        ax.set_ylim(*limits)
        what = "Friction of the ice" if curling else "Friction"
        title(figure, f"{what} against speed", given)
        if handles:
            rows = legend_below(figure, handles, given)
            if on is None:
                figure.set_figheight(2.6 + 0.2 * rows)
    return figure


def _span(glide: Glide, tracks: pd.DataFrame) -> tuple[float, float] | None:
    """Least and greatest speed of a glide, m/s."""
    rows = rows_of(tracks, glide.stone)
    rows = rows[(rows["t"] >= glide.t0) & (rows["t"] <= glide.t1)]
    speed = speeds(rows)[0]
    speed = speed[np.isfinite(speed)]
    return (float(speed.min()), float(speed.max())) if len(speed) else None


def _tells(glide: Glide, friction: Friction) -> bool:
    """Whether a glide tells its friction to within as much as that of the shot, or its error."""
    most = max(abs(friction.value or 0.0), 2 * (friction.stderr or 0.0))
    return not most or 2 * (glide.stderr or 0.0) <= most


def _draw_glide(
    ax: Axes,
    glide: Glide,
    slow: float,
    fast: float,
    colour: str,
    alpha: float,
    limits: tuple[float, float],
) -> None:
    mu, stderr = float(glide.friction or 0.0), glide.stderr or 0.0
    look: dict[str, Any] = {"color": colour, "alpha": alpha, "zorder": 4}
    middle = (slow + fast) / 2
    if limits[0] < mu < limits[1]:
        ax.plot([slow, fast], [mu, mu], lw=2.2, **look)
        ax.errorbar(middle, mu, 2 * stderr, fmt="none", capsize=3, lw=1.2, **look)
    else:
        edge, sign = (limits[0], "v") if mu <= limits[0] else (limits[1], "^")
        ax.plot(middle, edge, sign, ms=7, mew=0, clip_on=False, **look)


def _friction(law: IceLaw, speed: Array) -> Array:
    return np.asarray(law.deceleration(speed)) / GRAVITY


def _limits(glides: Sequence[Glide], friction: Friction, curling: bool) -> tuple[float, float]:
    """Limits that show the law and some glides, large errors cut."""
    values = [friction.value or 0.0, *(MEASURED if curling else ())]
    values += [float(glide.friction or 0.0) for glide in glides]
    span = max(max(values) - min(values), 0.3 * max(map(abs, values)), 1e-4)
    for glide in glides:
        reach = min(2 * (glide.stderr or 0.0), 0.7 * span)
        values += [float(glide.friction or 0.0) + sign * reach for sign in (-1, 1)]
    return min(values) - 0.1 * span, max(values) + 0.1 * span
