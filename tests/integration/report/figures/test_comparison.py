from __future__ import annotations

import pytest

from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_comparison_has_a_line_per_model(shot, stone):
    figure = figures.comparison_figure(
        shot.tracks, shot.simulations, stone, shot.results.collisions
    )
    check_layout(figure)
    (legend,) = figure.legends
    names = [t.get_text() for t in legend.get_texts()]
    assert names[1:] == ["point-mass", "rigid-body", "frictional"]
