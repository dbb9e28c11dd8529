from __future__ import annotations

import dataclasses
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from data.results import MeasuredState
from data.sheet import HOUSE
from report import figures
from report.style import render, styled


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


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_motion_says_the_fitted_velocities(shot, stone):
    collisions = shot.results.collisions
    figure = figures.motion_figure(shot.tracks, stone, collisions)
    check_layout(figure)
    assert len(figure.axes) == 3
    said = " ".join(t.get_text() for t in texts(figure))
    for hit in collisions:
        if stone in hit.stones:
            for value in (hit.before[stone].vx, hit.after[stone].vy, hit.after[stone].omega):
                assert f"{abs(value):.3f}" in said


def test_motion_without_angle_has_no_empty_panel(shot):
    tracks = shot.tracks.assign(theta=np.nan, omega=np.nan, sd_theta=np.nan)
    figure = figures.motion_figure(tracks, "A", shot.results.collisions)
    check_layout(figure)
    assert [ax.get_ylabel() for ax in figure.axes] == ["$x$ (m)", "$y$ (m)"]


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_comparison_has_a_line_per_model(shot, stone):
    figure = figures.comparison_figure(
        shot.tracks, shot.simulations, stone, shot.results.collisions
    )
    check_layout(figure)
    (legend,) = figure.legends
    names = [t.get_text() for t in legend.get_texts()]
    assert names[1:] == ["point-mass", "rigid-body", "frictional"]


def test_speed_is_cut_at_hits(shot):
    figure = figures.speed_figure(shot.tracks, shot.results.collisions)
    check_layout(figure)
    line = figure.axes[0].lines[0]
    t, speed = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert np.isnan(speed).sum() == 1
    assert np.nanmax(np.abs(np.diff(speed))) < 0.05
    assert t[0] == 0


@pytest.mark.parametrize("house", [HOUSE, None])
def test_plan_shows_every_stone_to_scale(shot, house):
    figure = figures.plan_figure(
        shot.tracks, shot.simulations, shot.results.collisions, house=house
    )
    check_layout(figure)
    (ax,) = figure.axes
    assert {"A", "B", "C", "D"} <= {t.get_text() for t in ax.texts}
    radii = [round(p.get_radius(), 4) for p in ax.patches]
    assert radii.count(0.1455) == 4 + 9
    assert radii.count(1.829) == (house is not None)
    assert ax.get_aspect() == 1


def test_hit_gives_normal_and_tangential_parts(shot):
    for rank, hit in enumerate(shot.results.collisions, 1):
        figure = figures.hit_figure(hit, rank)
        check_layout(figure)
        state = hit.after[hit.stones[1]]
        along = state.vx * hit.normal[0] + state.vy * hit.normal[1]
        assert f"{along:.3f}" in [t.get_text() for t in texts(figure)]


def test_plan_of_stones_that_were_seen_once(shot):
    one = shot.tracks[shot.tracks["frame"] == 0]
    check_layout(figures.plan_figure(one, house=HOUSE))
    check_layout(figures.plan_figure(one, house=None))


def test_long_and_strange_names_and_close_hits_fit(shot):
    new = {"A": "red stone $x_1$ <the first one>", "B": "масса Б", "C": "_c", "D": "石"}
    tracks = shot.tracks.replace({"stone": new})
    first = shot.results.collisions[0]

    def renamed(side: dict[str, MeasuredState]) -> dict[str, MeasuredState]:
        return {new[name]: state for name, state in side.items()}

    hits = [
        dataclasses.replace(
            first,
            t=0.8 + 0.06 * k,
            stones=(new["A"], new["B"]),
            before=renamed(first.before),
            after=renamed(first.after),
        )
        for k in range(6)
    ]
    simulations = {k: v.replace({"stone": new}) for k, v in shot.simulations.items()}
    for figure in (
        figures.plan_figure(tracks, simulations, hits, house=None),
        figures.speed_figure(tracks, hits),
        figures.motion_figure(tracks, new["A"], hits),
        figures.comparison_figure(tracks, simulations, new["B"], hits),
        figures.hit_figure(hits[0], 1),
    ):
        check_layout(figure)


def test_long_delivery_keeps_the_house_in_view(shot):
    tracks = shot.tracks.copy()
    thrown = tracks["stone"] == "A"
    tracks.loc[thrown, "y"] = np.linspace(30, 0.5, thrown.sum())
    figure = figures.plan_figure(tracks, house=HOUSE)
    check_layout(figure)
    low, high = figure.axes[0].get_ylim()
    assert low < -1.829
    assert 1.829 < high < 12


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
