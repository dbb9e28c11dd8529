from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.results import Friction
from curlshot.report import figures
from curlshot.report.style import BLACK
from curlshot.tests.helpers.report.drawn import check_layout


@pytest.mark.parametrize("curling", [True, False])
@pytest.mark.parametrize(
    "law", [Friction(0.0109, 4e-4), Friction(0.0109, 4e-4, "fit", 2e-3, 0.06, 0.009), Friction()]
)
def test_friction_shows_law_and_glides(shot, law, curling):
    figure = figures.friction_figure(shot.results.glides, law, shot.tracks, curling=curling)
    check_layout(figure)
    (ax,) = figure.axes
    low, high = ax.get_ylim()
    assert low < 0.0109 < high
    said = [t.get_text() for t in figure.legends[0].get_texts()]
    assert any("Penner" in text for text in said) == curling
    assert {"stone A", "stone C"} <= set(said)
    if law.value is not None:
        black = next(line for line in ax.lines if line.get_color() == BLACK)
        assert np.interp(1.0, *black.get_data()) == pytest.approx(
            0.0109 if law.law == "constant" else 2e-3 / 1.06 + 0.009, rel=1e-4
        )
