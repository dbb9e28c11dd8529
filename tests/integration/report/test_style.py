from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from curlshot.data.sheet import HOUSE
from curlshot.report import figures
from curlshot.report.style import PNG_DPI, render


def test_drawing_leaves_the_session_as_it_was(shot):
    before = dict(matplotlib.rcParams)
    with matplotlib.rc_context({"font.size": 20, "text.usetex": False, "axes.grid": False}):
        settings = dict(matplotlib.rcParams)
        svg, png = render(figures.speed_figure(shot.tracks))
        assert dict(matplotlib.rcParams) == settings
    assert dict(matplotlib.rcParams) == before
    assert svg.startswith(b"<?xml")
    assert png.startswith(b"\x89PNG")
    assert render(figures.speed_figure(shot.tracks))[0] == svg


def test_a_png_is_small_and_its_paper_white(shot):
    figure = figures.plan_figure(shot.tracks, shot.simulations, house=HOUSE)
    _, png = render(figure)
    assert len(png) < 100_000
    picture = Image.open(BytesIO(png))
    wide, high = (int(size * PNG_DPI) for size in figure.get_size_inches())
    assert picture.size == (wide, high)
    colours = picture.convert("RGB").getcolors()
    assert colours is not None
    assert max(colours)[1] == (255, 255, 255)
    true = np.asarray(picture.convert("RGB"), int)
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(PNG_DPI)
    canvas.draw()
    off = np.abs(true - np.asarray(canvas.buffer_rgba())[:, :, :3])
    assert off.mean() < 1.5  # of 255
