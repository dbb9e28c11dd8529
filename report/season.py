"""A season in one picture: e and μ of every shot, what all say together, e against speed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from curlshot.data.files import write_text
from curlshot.data.tracks import write_table
from curlshot.physics.statistics.pool import Pooled
from curlshot.report.figures.parts import short
from curlshot.report.numbers import plus_minus
from curlshot.report.style import BLACK, BLUE, GREY, PNG_DPI, SKY, new_figure, styled

ROW = 0.24
"""Height of a shot's row, inches."""

LONGEST = 28
"""Letters of a shot's name that are shown."""


def write_season(
    folder: Path, shots: pd.DataFrame, hits: pd.DataFrame, pooled: Mapping[str, Pooled], page: str
) -> None:
    """Write a season as two tables, in sum, as a picture (`season_figure`) and as a page."""
    content = {
        "schema": 1,
        "shots": shots["shot"].tolist(),
        **{law: asdict(mean) for law, mean in pooled.items()},
    }
    write_table(shots, folder / "shots.csv")
    write_table(hits, folder / "hits.csv")
    write_text(folder / "season.json", json.dumps(content, indent=1, ensure_ascii=False) + "\n")
    write_text(folder / "season.html", page)
    season_figure(shots, hits, pooled).savefig(folder / "season.png", dpi=PNG_DPI)


def season_figure(shots: pd.DataFrame, hits: pd.DataFrame, pooled: Mapping[str, Pooled]) -> Figure:
    """Draw e and μ of the shots with their errors and the season's mean, and e against speed.

    Parameters
    ----------
    shots, hits : DataFrame
        From `curlshot.physics.statistics.season.shots_table` and `hits_table`.
    pooled : mapping
        From `curlshot.physics.statistics.season.pooled`.

    Returns
    -------
    Figure
    """
    with styled():
        height = max(3.2, 1.4 + ROW * len(shots))
        figure = new_figure(11.0, height)
        left, middle, right = figure.subplots(1, 3, width_ratios=(1, 1, 1.1))
        _forest(left, shots, "restitution", pooled["restitution"], "restitution e")
        handles, labels = left.get_legend_handles_labels()
        _forest(middle, shots, "friction", pooled["friction"], "friction μ of the ice")
        middle.set_yticklabels([])
        _against_speed(right, hits, pooled["restitution"])
        if labels[:-1]:
            figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _forest(axes: Axes, shots: pd.DataFrame, name: str, mean: Pooled, label: str) -> None:
    rows = np.arange(len(shots))[::-1]
    axes.errorbar(
        shots[name], rows, xerr=shots[f"stderr_{name}"],
        fmt="o", ms=4, color=BLUE, capsize=2, label="one shot ± its standard error",
    )  # fmt: skip
    if mean.value is not None and mean.stderr is not None:
        axes.axvline(mean.value, color=BLACK, lw=1, label="mean of all shots")
        # Either may be the wider: an area and an outline show both.
        area: dict[str, Any] = {"color": SKY, "alpha": 0.4, "lw": 0}
        outline: dict[str, Any] = {"fill": False, "ec": BLACK, "ls": "--", "lw": 1}
        for half, look, what in (
            (mean.stderr, area, "its standard error"),
            (mean.scatter, outline, "scatter from shot to shot"),
        ):
            if half is not None:
                axes.axvspan(mean.value - half, mean.value + half, label=what, **look)
    axes.set_yticks(rows, [short(shot, LONGEST) for shot in shots["shot"]])
    axes.set_ylim(-0.7, len(shots) - 0.3)
    axes.set_xlabel(label)
    axes.set_title(f"{label.split()[1]} = {plus_minus(mean.value, mean.stderr)}")
    axes.grid(axis="y", visible=False)
    if shots[name].isna().all():
        _nothing(axes, "not known from any shot")


def _nothing(axes: Axes, why: str) -> None:
    """Say why there is nothing to see, in place of numbers that mean nothing."""
    axes.set_xticks([])
    axes.text(0.5, 0.5, why, color=GREY, ha="center", va="center", transform=axes.transAxes)


def _against_speed(axes: Axes, hits: pd.DataFrame, mean: Pooled) -> None:
    axes.errorbar(
        hits["closing_speed"], hits["restitution"], yerr=hits["stderr"],
        fmt="o", ms=4, color=GREY, mec=BLUE, mfc=BLUE, capsize=2,
    )  # fmt: skip
    if mean.value is not None:
        axes.axhline(mean.value, color=BLACK, lw=1)
    axes.set_xlabel("closing speed along the normal (m/s)")
    axes.set_ylabel("restitution e of the hit")
    axes.set_title("Each hit ± its standard error")
    if hits["restitution"].isna().all():
        axes.set_yticks([])
        _nothing(axes, "not known from any hit")
