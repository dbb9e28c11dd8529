"""A run in a notebook: figures that show themselves, and the answer as HTML."""

from __future__ import annotations

import base64
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from curlshot.data.arguments import check_type
from curlshot.report.figures import plan_figure
from curlshot.report.figures.parts import OnAxes
from curlshot.report.numbers import DASH, count
from curlshot.report.style import inline_svg, png_of, shown
from curlshot.report.summary import nearest_model, nearest_text, shot_stone_text

if TYPE_CHECKING:
    from curlshot.outcome import Run

MOST_ROWS = 20
"""Hits, and warnings, that are listed."""
LARGEST = 40_000
"""Bytes of a drawing of lines; a larger one is a picture of points."""
DPI = 80


def drawn(draw: Callable[[OnAxes], Figure], on: OnAxes) -> NDArray[np.object_]:
    """Draw a figure on given axes, or on new ones that a notebook shows; return the axes."""
    if on is not None:
        given = np.asarray(on, object).ravel()
        for one in given:
            check_type("`ax`", one, Axes, "axes of matplotlib")
        draw(on)
        return given
    with shown():
        figure = draw(None)
    axes = np.empty(len(figure.axes), object)
    axes[:] = figure.axes
    return axes


def run_html(run: Run) -> str:
    """Return the answer of a run, its plan and its hits as HTML."""
    results = run.results
    rows = [("e", str(run.restitution)), ("μ", str(run.friction))]
    rows += [("simulated", text) for text in nearest_text(results, run.unit)]
    if run.house is not None and len(run.tracks):
        rows.append(("shot stone", shot_stone_text(results, run.tracks, run.house, run.unit)))
    answer = Markup("").join(
        Markup("<tr><th style='text-align:left'>{}</th><td style='text-align:left'>{}</td></tr>")
        .format(name, text) for name, text in rows
    )  # fmt: skip
    parts = [
        Markup("<p><b>{}</b>: {}, {}</p>").format(
            ", ".join(results.input.files[:3]) or "shot",
            count(results.input.frames, "frame"),
            count(len(results.collisions), "hit"),
        ),
        Markup("<table>{}</table>").format(answer),
    ]
    if len(run.tracks):
        parts.append(_plan(run))
    if results.collisions:
        parts.append(_hits(run))
    if results.warnings:
        items = [*results.warnings[:MOST_ROWS]]
        if len(items) < len(results.warnings):
            items.append(f"and {len(results.warnings) - len(items)} more")
        listed = Markup("").join(Markup("<li>{}</li>").format(text) for text in items)
        parts.append(Markup("<ul>{}</ul>").format(listed))
    return str(Markup("<div>{}</div>").format(Markup("\n").join(parts)))


def _hits(run: Run) -> Markup:
    heads = ("hit", "t (s)", "stones", "e", "closing speed (m/s)")
    table = run.hits
    rows = [
        (
            str(row["hit"]), f"{row['t']:.3f}", f"{row['first']} on {row['second']}",
            str(hit.e), f"{row['closing_speed']:.3f}" if row["closing_speed"] >= 0 else DASH,
        )
        for row, hit in zip(
            table.head(MOST_ROWS).to_dict("records"), run.results.collisions, strict=False
        )
    ]  # fmt: skip
    head = Markup("").join(Markup("<th>{}</th>").format(text) for text in heads)
    body = Markup("").join(
        Markup("<tr>{}</tr>").format(
            Markup("").join(Markup("<td>{}</td>").format(text) for text in row)
        )
        for row in rows
    )
    return Markup("<table><tr>{}</tr>{}</table>").format(head, body)


def _plan(run: Run) -> Markup:
    """Return the plan with the nearest simulation as inline SVG; with many lines as PNG."""
    model, simulated = nearest_model(run.results), run.simulated
    figure = plan_figure(
        run.tracks,
        {} if model not in simulated else {model: simulated[model]},
        run.results.collisions,
        house=run.house,
        radius=run.results.radius,
    )
    text = inline_svg(figure)
    if len(text) <= LARGEST:
        return Markup(text)
    code = base64.b64encode(png_of(figure, DPI)).decode()
    return Markup("<img alt='plan' src='data:image/png;base64,{}'>").format(code)
