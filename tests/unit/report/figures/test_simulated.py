from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Circle

from curlshot.data.sheet import HOUSE, SHEET
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, Simulation, StoneStart
from curlshot.report.figures import simulated_figure
from curlshot.tests.helpers.report.drawn import check_layout, texts


def thrown(vy: float, y: float = -5.0, x: float = 0.05) -> Simulation:
    stones = StoneStart("A", 0.0, y, 0.0, vy), StoneStart("B", x, 0.0), StoneStart("$C", 1.2, 1.0)
    return simulate(Shot(stones, bounds=Bounds(1)))


def sampled(simulation: Simulation):
    return simulation.sample(np.linspace(0, max(r.t for r in simulation.rest.values()), 200))


def discs(figure) -> list[tuple[float, float]]:
    return [p.center for p in figure.axes[0].patches if isinstance(p, Circle) and p.get_lw() > 1]


@pytest.mark.parametrize("play", [-1, 1])
def test_the_back_line_lies_behind_the_tee(play: int) -> None:
    simulation = thrown(1.1)
    (ax,) = simulated_figure(sampled(simulation), house=HOUSE, play=play).axes
    across = [line.get_ydata()[0] for line in ax.lines if np.ptp(line.get_ydata()) == 0]
    assert SHEET.back_line * play in across
    assert -SHEET.back_line * play not in across


def test_stones_are_drawn_where_they_come_to_rest_and_hits_where_they_touch() -> None:
    simulation = thrown(1.1)
    figure = simulated_figure(sampled(simulation), simulation.hits, house=HOUSE)
    check_layout(figure)
    ends = [(rest.x, rest.y) for rest in simulation.rest.values()]
    for end in ends:
        assert min(np.hypot(*np.subtract(end, disc)) for disc in discs(figure)) < 1e-3
    (hit,) = simulation.hits
    crosses = [line.get_xydata()[0] for line in figure.axes[0].lines if line.get_marker() == "x"]
    one, two = (hit.before[name] for name in hit.stones)
    assert crosses == [pytest.approx(((one.x + two.x) / 2, (one.y + two.y) / 2), abs=1e-6)]
    words = {text.get_text() for text in texts(figure)}
    assert {"start", "hit", "Simulated: 3 stones, 1 hit"} <= words


@pytest.mark.parametrize("house", [HOUSE, None])
def test_what_ends_out_of_view_is_told(house) -> None:
    away = thrown(1.0, -20.0)
    figure = simulated_figure(sampled(away), gone=away.gone, house=house)
    check_layout(figure)
    low, high = figure.axes[0].get_ylim()
    assert high - low < 14
    (told,) = [text.get_text() for text in texts(figure) if "A " in text.get_text()]
    place = away.rest["A"]
    assert told.startswith("A leaves the sheet at (") and f"{abs(place.y):.1f}" in told
    gone = simulated_figure(sampled(away), house=house)
    assert any(text.get_text().startswith("A continues to (") for text in texts(gone))
