from __future__ import annotations

import dataclasses

from report import figures
from tests.report.figures.drawn import check_layout


def test_close_hits_share_a_label(shot):
    hit = shot.results.collisions[0]
    hits = [dataclasses.replace(hit, t=t) for t in (0.8, 0.81, 0.83, 4.0, 6.0, 6.02)]
    figure = figures.speed_figure(shot.tracks, hits)
    check_layout(figure)
    assert [t.get_text() for t in figure.axes[0].texts] == ["1–3", "4", "5, 6"]
