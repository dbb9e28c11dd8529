"""What is known of restitution and friction together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from curlshot.data.results import JointEstimate
from curlshot.report.figures.parts import WIDTH, Array, OnAxes, legend_below, line, panels, title
from curlshot.report.numbers import plus_minus
from curlshot.report.style import BLUE, GREY, PALE, styled

NAMES = {
    "restitution": "$e$",
    "friction": "μ of the ice",
    "stone_friction": "μ between stones",
}
"""What the unknowns of a shot are called, in their order."""

_LEVELS = (1.0, 2.0)
"""Ellipses drawn, in standard deviations: 39 % and 86 % of the probability of two unknowns."""

_MOST_DOTS = 2000


def posterior_figure(
    laws: JointEstimate | None, samples: pd.DataFrame | None = None, on: OnAxes = None
) -> Figure:
    """Distribution of restitution and frictions: each alone on the diagonal, pairs below it.

    Lines are the normal distribution that values and covariance stand for, with ellipses of
    one and two standard deviations; samples, where given, are histograms and dots.

    Parameters
    ----------
    laws : JointEstimate or None
        Values and covariance of some of ``restitution, friction, stone_friction``.
    samples : DataFrame, optional
        A column for each, a row a sample.
    on : sequence of Axes, optional
        Where to draw, a square of panels, a row for each; a figure of its own without.

    Raises
    ------
    ValueError
        Where there is neither.
    """
    samples = None if samples is None else samples.dropna(axis=1, how="all")
    known = set(laws.names if laws is not None else ()) | set(
        () if samples is None else samples.columns
    )
    names = [name for name in NAMES if name in known]
    if not names:
        raise ValueError("neither a shot fit nor samples: nothing to draw")
    ranges = {name: _range(name, laws, samples) for name in names}
    count = len(names)
    with styled():
        figure, grid = panels(on, WIDTH, 1.0 + 1.55 * count, count, count, sharex="col")
        first, last = (None, None) if on is None else grid[[0, -1], 0]
        for i, below in enumerate(names):
            for j, across in enumerate(names):
                ax = grid[i, j]
                if j > i:
                    ax.set_axis_off()
                elif i == j:
                    _draw_one(ax, across, ranges[across], laws, samples)
                else:
                    _draw_two(ax, across, below, laws, samples)
                    ax.set_ylim(*ranges[below])
                ax.set_xlim(*ranges[across])
                ax.locator_params(axis="x", nbins=2, min_n_ticks=2, steps=[1, 2, 4, 5, 10])
                ax.ticklabel_format(useOffset=False)
                if i == count - 1:
                    ax.set_xlabel(NAMES[across])
                if j == 0 and i > 0:
                    ax.set_ylabel(NAMES[below])
                elif i != j:
                    ax.tick_params(labelleft=False)
                if j < i:  # the lines of a row are those of its numbers at the left
                    ax.locator_params(axis="y", nbins=4)
        title(figure, "Joint uncertainty of restitution and friction", first)
        handles = []
        if laws is not None:
            handles.append(line("fit: 1 and 2 standard deviations", color=BLUE))
        if samples is not None:
            handles.append(line("samples", color=GREY, marker="s", ls="none", mew=0))
        legend_below(figure, handles, last)
    return figure


def _part(laws: JointEstimate | None, names: list[str]) -> tuple[Array, Array] | None:
    """Values and covariance of some unknowns, None where not all of them are known."""
    if laws is None or not set(names) <= set(laws.names):
        return None
    at = [laws.names.index(name) for name in names]
    return np.array(laws.values)[at], np.array(laws.cov)[np.ix_(at, at)]


def _range(
    name: str, laws: JointEstimate | None, samples: pd.DataFrame | None
) -> tuple[float, float]:
    ends: list[float] = []
    part = _part(laws, [name])
    if part is not None:
        value, sd = float(part[0][0]), float(np.sqrt(part[1][0, 0]))
        ends += [value - 3.5 * sd, value + 3.5 * sd]
    if samples is not None and name in samples:
        ends += np.quantile(samples[name].dropna(), [0.001, 0.999]).tolist()
    low, high = min(ends), max(ends)
    return (low, high) if high > low else (low - 1e-3, high + 1e-3)


def _draw_one(
    ax: Axes,
    name: str,
    limits: tuple[float, float],
    laws: JointEstimate | None,
    samples: pd.DataFrame | None,
) -> None:
    ax.set_yticks([])
    ax.grid(False)
    ax.spines["left"].set_visible(False)
    if samples is not None and name in samples:
        ax.hist(samples[name], bins=np.linspace(*limits, 41).tolist(), density=True, color=PALE)
        middle, sd = float(samples[name].mean()), float(samples[name].std())
    part = _part(laws, [name])
    if part is not None:
        middle, sd = float(part[0][0]), float(np.sqrt(part[1][0, 0]))
        x = np.linspace(*limits, 200)
        density = np.exp(-(((x - middle) / sd) ** 2) / 2) / (sd * np.sqrt(2 * np.pi))
        ax.plot(x, density, color=BLUE)
    ax.set_ylim(bottom=0)
    ax.set_title(
        f"{NAMES[name]}\n{plus_minus(middle, sd)}", fontsize=8.5, fontweight="normal", loc="center"
    )


def _draw_two(
    ax: Axes, across: str, below: str, laws: JointEstimate | None, samples: pd.DataFrame | None
) -> None:
    if samples is not None and {across, below} <= set(samples.columns):
        dots: dict[str, Any] = {"color": GREY, "ms": 2, "alpha": 0.4, "mew": 0}
        shown = samples.iloc[:: max(1, len(samples) // _MOST_DOTS)]
        ax.plot(shown[across], shown[below], ".", rasterized=True, **dots)
    part = _part(laws, [across, below])
    if part is None:
        return
    values, cov = part
    sizes, axes = np.linalg.eigh(cov)
    angle = float(np.degrees(np.arctan2(axes[1, 1], axes[0, 1])))
    for level in _LEVELS:
        small, large = 2 * level * np.sqrt(np.maximum(sizes, 0))
        ax.add_patch(
            Ellipse(
                (float(values[0]), float(values[1])), large, small, angle=angle,
                fill=False, ec=BLUE, lw=1.2,
            )
        )  # fmt: skip
    ax.plot(*values, "+", color=BLUE, ms=6)
