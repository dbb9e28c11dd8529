from __future__ import annotations

from curlshot.data.sheet import HOUSE
from curlshot.report.gallery import pictures


def test_a_figure_is_drawn_when_asked(shot):
    plan = next(iter(pictures(shot.results, shot.tracks, shot.simulations, HOUSE)))
    assert plan.caption.startswith("Plan view: measured paths")
    assert "4 stones, of which 3 moved" in plan.alt
    assert len(plan.draw().axes) == 1
    assert plan.draw() is not plan.draw()
