from __future__ import annotations

import pytest
from matplotlib.colors import to_rgba

from curlshot.data.results import Friction, Glide
from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout


def test_the_range_that_was_measured_is_as_pale_in_the_legend(shot):
    figure = figures.friction_figure(shot.results.glides, Friction(0.0109, 4e-4), shot.tracks)
    (ax,), (legend,) = figure.axes, figure.legends
    (drawn,) = [entry for entry in legend.legend_handles if "measured" in entry.get_label()]
    (range_of_others,) = [band for band in ax.patches if band.get_height() > 0.009]
    assert to_rgba(drawn.get_color(), drawn.get_alpha()) == range_of_others.get_facecolor()


def test_a_glide_that_tells_next_to_nothing_leaves_the_axis_as_it_is(shot):
    law, told = Friction(0.0109, 4e-4), shot.results.glides
    usual = figures.friction_figure(told, law, shot.tracks).axes[0].get_ylim()
    poor = Glide("B", 1.52, 3.0, 0.06, 0.02)
    figure = figures.friction_figure((*told, poor), law, shot.tracks)
    check_layout(figure)
    (ax,) = figure.axes
    assert ax.get_ylim() == usual
    (arrow,) = [item for item in ax.lines if item.get_marker() == "^"]
    assert arrow.get_ydata() == pytest.approx([usual[1]])
    assert any("uncertain" in text.get_text() for text in figure.legends[0].get_texts())
    sure = Glide("B", 1.52, 3.0, 0.06, 0.002)
    assert figures.friction_figure((*told, sure), law, shot.tracks).axes[0].get_ylim()[1] > 0.06


def test_many_stones_leave_the_panel_its_height(shot):
    glides = [Glide(stone, 0.0, 6.0, 0.0109, 1e-3) for stone in "ABCD"]
    law = Friction(0.0109, 4e-4, "fit", 2e-3, 0.06, 0.009)
    figure = figures.friction_figure(glides, law, shot.tracks)
    check_layout(figure)
    assert figure.axes[0].get_window_extent().height / figure.dpi > 1.7


def test_where_the_shot_tells_little_glides_that_tell_no_less_are_not_pale(shot):
    law = Friction(1e-3, 4e-3)
    for stderr, poor in ((3e-3, False), (6e-3, True)):
        glides = [Glide("A", 0.0, 6.0, 2e-3, stderr)]
        figure = figures.friction_figure(glides, law, shot.tracks)
        said = [text.get_text() for text in figure.legends[0].get_texts()]
        assert any("uncertain" in text for text in said) == poor
