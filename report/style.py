"""One look for all figures, safe for the colour-blind, without a trace in the user's session.

Colours: Okabe and Ito, Color Universal Design, 2008.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from typing import Any

import matplotlib.style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.colors import is_color_like, to_hex
from matplotlib.figure import Figure
from PIL import Image

from curlshot.data.text import printable

BLACK = "#1a1a1a"
GREY = "#7a7a7a"
PALE = "#d9d9d9"
BLUE = "#0072b2"
SKY = "#56b4e9"
GREEN = "#009e73"
ORANGE = "#e69f00"
VERMILLION = "#d55e00"
PURPLE = "#cc79a7"

BEFORE, AFTER = VERMILLION, BLUE
"""Colours of what was fitted before and after a hit."""

RING_FILLS = ("#dde7f0", "#ffffff", "#f3e3dc", "#ffffff")
"""From the outer ring inwards: pale enough for any line on top."""

_STONES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, "#8c6d1f", "#6a51a3")
_MODELS: dict[str, tuple[str, Any]] = {
    "point-mass": (BLUE, (0, (5, 2))),
    "rigid-body": (VERMILLION, (0, (5, 1.5, 1, 1.5))),
    "frictional": (GREEN, (0, (1.5, 1.5))),
}
_OTHER_MODELS = ((PURPLE, (0, (8, 2))), (ORANGE, (0, (3, 1, 1, 1, 1, 1))), (SKY, (0, (1, 3))))

STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9,
    "axes.edgecolor": GREY,
    "axes.labelcolor": BLACK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "xtick.color": BLACK,
    "ytick.color": BLACK,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "text.color": BLACK,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "legend.title_fontsize": 8,
    "legend.handlelength": 2.4,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.fonttype": "path",  # the same picture on every machine
    "svg.hashsalt": "curlshot",  # the same file from the same numbers
}

PNG_DPI = 200

_COLOURS = 256
"""Colours of a PNG: more than figures have, for a third of the bytes."""


@contextmanager
def styled() -> Iterator[None]:
    """Draw in the house style inside the block; the session's settings come back after it."""
    with warnings.catch_warnings(), matplotlib.style.context(["default", STYLE], after_reset=True):
        # A stone's name may use letters that the font lacks: a box in the picture says enough.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


_SHOWN: ContextVar[bool] = ContextVar("shown", default=False)


@contextmanager
def shown() -> Iterator[None]:
    """Make figures inside the block that notebooks and windows show."""
    before = _SHOWN.set(True)
    try:
        yield
    finally:
        _SHOWN.reset(before)


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure, inches; no window or notebook knows about it, but within `shown`."""
    if _SHOWN.get():
        from matplotlib import pyplot

        return pyplot.figure(figsize=(width, height), layout="constrained")
    return Figure(figsize=(width, height), layout="constrained")


def stone_colours(stones: Iterable[str]) -> dict[str, str]:
    """Give each stone its colour, by the order of the names."""
    return {name: _STONES[rank % len(_STONES)] for rank, name in enumerate(sorted(stones))}


def team_colour(team: str) -> str | None:
    """Colour (#rrggbb) by which a team is called; None where it has another name, or none."""
    return to_hex(team) if team and is_color_like(team) else None


def model_lines(models: Iterable[str]) -> dict[str, tuple[str, Any]]:
    """Give each model of the simulation its colour and dash pattern."""
    lines: dict[str, tuple[str, Any]] = {}
    spare = 0
    for name in models:
        if name in _MODELS:
            lines[name] = _MODELS[name]
        else:
            lines[name] = _OTHER_MODELS[spare % len(_OTHER_MODELS)]
            spare += 1
    return lines


def plain_text(name: str) -> str:
    """Return a name that matplotlib prints as it is, without reading formulas into it."""
    return printable(name).replace("$", r"\$")


def render(figure: Figure) -> tuple[bytes, bytes]:
    """Return the figure as SVG and as PNG, the layout worked out once."""
    with styled():
        # By the canvases themselves: ``savefig`` would draw each once more before.
        png = png_of(figure)
        svg = BytesIO()
        figure.set_layout_engine("none")  # placed by now; a second pass would cost as much again
        FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None})  # type: ignore[no-untyped-call]
    return svg.getvalue(), png


def inline_svg(figure: Figure) -> str:
    """Return the figure as an SVG element for a page, its text as text, which is short."""
    svg = BytesIO()
    with styled(), matplotlib.rc_context({"svg.fonttype": "none"}):
        FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None})  # type: ignore[no-untyped-call]
    text = svg.getvalue().decode()
    return re.sub(r">\s+<", "><", text[text.index("<svg") :])


def png_of(figure: Figure, dpi: int = PNG_DPI) -> bytes:
    """Return the figure as PNG with a palette."""
    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = bytes(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    picture = Image.frombuffer("RGBA", canvas.get_width_height(), pixels).convert("RGB")
    few = picture.quantize(_COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    palette = few.getpalette() or []
    paper = 3 * few.tobytes()[0]  # a palette's colours are means: the paper's shall be white
    palette[paper : paper + 3] = 255, 255, 255
    few.putpalette(palette)
    png = BytesIO()
    few.save(png, "png", dpi=(dpi, dpi))
    return png.getvalue()
