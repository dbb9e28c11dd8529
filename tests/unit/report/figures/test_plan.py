from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Ellipse

from curlshot.data.sheet import HOUSE, SHEET
from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout


def test_the_back_line_lies_behind_the_tee(shot):
    down = bool(shot.tracks.loc[shot.tracks["stone"] == "A", "vy"].iloc[0] < 0)
    other = shot.tracks.assign(y=-shot.tracks["y"], vy=-shot.tracks["vy"])
    for tracks, sign in ((shot.tracks, -1 if down else 1), (other, 1 if down else -1)):
        (ax,) = figures.plan_figure(tracks, house=HOUSE).axes
        across = [line.get_ydata()[0] for line in ax.lines if np.ptp(line.get_ydata()) == 0]
        assert SHEET.back_line * sign in across
        assert -SHEET.back_line * sign not in across


def test_ellipses_are_enlarged_as_the_legend_says(shot):
    figure = figures.plan_figure(shot.tracks, house=HOUSE)
    (ax,), (legend,) = figure.axes, figure.legends
    (said,) = [t.get_text() for t in legend.get_texts() if "sd" in t.get_text()]
    factor = int(said.split(",")[1].split()[0])
    sizes = [p.get_width() for p in ax.patches if type(p) is Ellipse]
    assert len(sizes) == 4
    assert sizes == pytest.approx([2 * 2 * 0.004 * factor] * 4)


def test_long_delivery_keeps_the_house_in_view(shot):
    tracks = shot.tracks.copy()
    thrown = tracks["stone"] == "A"
    tracks.loc[thrown, "y"] = np.linspace(30, 0.5, thrown.sum())
    figure = figures.plan_figure(tracks, house=HOUSE)
    check_layout(figure)
    low, high = figure.axes[0].get_ylim()
    assert low < -1.829
    assert 1.829 < high < 12


def test_without_a_house_the_whole_way_is_in_view(shot):
    tracks = shot.tracks[shot.tracks["stone"] == "A"].copy()
    tracks["y"] = np.linspace(30, 0.5, len(tracks))
    figure = figures.plan_figure(tracks, house=None)
    check_layout(figure)
    low, high = figure.axes[0].get_ylim()
    assert low < 0.5
    assert high > 30


def test_a_path_goes_through_where_its_stone_was_hit(shot):
    hit = shot.results.collisions[0]
    stone = hit.stones[0]
    # Of few pictures the straight line between two of them cuts the corner.
    few = shot.tracks[shot.tracks["frame"] % 10 == 0]
    (ax,) = figures.plan_figure(few, collisions=[hit], house=None).axes
    where = np.array([hit.before[stone].x, hit.before[stone].y])
    apart = [np.hypot(*(np.array(line.get_data()) - where[:, None])).min() for line in ax.lines]
    assert min(apart) < 1e-9
