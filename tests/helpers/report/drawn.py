"""What a figure shows to a reader, and tables to draw."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from curlshot.report.style import styled
from curlshot.report.tables import residual_table


def texts(figure: Figure) -> list[Text]:
    """All texts that are drawn; ticks outside of their axis are not."""
    found = [*figure.texts]
    if figure.get_suptitle():
        found.append(figure._suptitle)
    for legend in figure.legends:
        found += legend.get_texts()
    for ax in figure.axes:
        found += [ax.title, ax.xaxis.label, ax.yaxis.label, *ax.texts]
        legend = ax.get_legend()
        if legend is not None:
            found += [*legend.get_texts(), legend.get_title()]
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            found += [
                tick.label1
                for tick in axis.get_major_ticks()
                if low - 1e-9 <= tick.get_loc() <= high + 1e-9 and tick.label1.get_visible()
            ]
    return [t for t in dict.fromkeys(found) if t.get_visible() and t.get_text().strip()]


def check_layout(figure: Figure) -> None:
    """Every text within the figure, no text on another."""
    assert isinstance(figure, Figure)
    with styled():
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        width, height = canvas.get_width_height()
        boxes = []
        for text in texts(figure):
            if not text.axes or text.axes.axison or text in text.axes.texts:
                box = text.get_window_extent(canvas.get_renderer())
                boxes.append((text.get_text(), box))
                assert box.x0 >= -0.5 and box.y0 >= -0.5, text
                assert box.x1 <= width + 0.5 and box.y1 <= height + 0.5, text
    for (one, a), (two, b) in combinations(boxes, 2):
        wide = min(a.x1, b.x1) - max(a.x0, b.x0)
        high = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert wide < 1 or high < 1, f"{one!r} on {two!r}"


def residuals(shot, sd=0.003):
    rng = np.random.default_rng(3)
    sighted = shot.tracks.assign(sd_x=sd, sd_y=sd)
    for axis in "xy":
        sighted[axis] += sd * rng.standard_normal(len(sighted))
    return residual_table(sighted, shot.tracks)
