from __future__ import annotations

import pytest

from curlshot.data.results import TrackResidual
from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout, residuals


def test_residuals_that_are_normal_look_so(shot):
    table = residuals(shot)
    assert table["dx"].std() == pytest.approx(0.003, rel=0.1)
    figure = figures.residuals_figure(table, shot.results.collisions)
    check_layout(figure)
    said = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert said[0].split()[0] in ("94", "95", "96")


def test_wild_detections_are_marks_at_the_edge(shot):
    table = residuals(shot)
    table.loc[7, "dx"] = 0.5
    table.loc[9, "dy"] = -0.5
    figure = figures.residuals_figure(table, shot.results.collisions)
    check_layout(figure)
    for ax, sign, row in ((figure.axes[0], 1, 7), (figure.axes[2], -1, 9)):
        low, high = ax.get_ylim()
        assert high < 20  # mm
        (mark,) = [
            line for line in ax.lines if line.get_marker() in (6, 7) and len(line.get_xdata())
        ]
        assert list(mark.get_xdata()) == [table.loc[row, "t"]]
        assert mark.get_ydata()[0] == (high if sign > 0 else low)
    said = [entry.get_text() for entry in figure.legends[0].get_texts()]
    assert {"± 2 sd, as estimated", "outside the plot"} <= set(said)


def test_what_the_whole_shot_leaves_out_has_a_bar_in_the_colour_of_its_stone(shot):
    misfits = (
        TrackResidual("A", 0.2, 0.9, 6.1, True, True),
        TrackResidual("B", 0.2, 0.9, 0.8, False, False),
    )
    figure = figures.residuals_figure(residuals(shot), shot.results.collisions, misfits)
    check_layout(figure)
    bars = [
        list(line.get_xdata()) for ax in figure.axes[::2] for line in ax.lines if line.get_lw() == 4
    ]
    assert bars == [[0.2, 0.9], [0.2, 0.9]]
    said = [entry.get_text() for entry in figure.legends[0].get_texts()]
    assert "down-weighted in the shot fit" in said
