from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from curlshot.report.figures.labels import name_stones

RADIUS = 0.1455


def labelled(places: dict[str, tuple[float, float]], metres: float, line=None):
    """A square plan of so many metres with its names, and their boxes in metres."""
    figure = Figure((4.0, 4.0))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(-metres / 2, metres / 2), ylim=(-metres / 2, metres / 2))
    if line is not None:
        ax.plot(*line)
    at = {name: np.array(place) for name, place in places.items()}
    name_stones(ax, at, dict.fromkeys(places, "black"), RADIUS, 4.0 / metres)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    into = ax.transData.inverted()
    boxes = {
        text.get_text(): into.transform(text.get_window_extent(canvas.get_renderer()).get_points())
        for text in ax.texts
    }
    return at, boxes


def test_a_short_name_stands_in_a_large_stone():
    at, boxes = labelled({"A": (0.3, -0.2)}, 2.0)
    np.testing.assert_allclose(boxes["A"].mean(axis=0), at["A"], atol=0.02)


@pytest.mark.parametrize("places", [(0.0, 0.0), (2.8, 2.8), (-2.9, 0.0)])
def test_a_long_name_stands_beside_its_stone_and_in_the_picture(places):
    at, boxes = labelled({"mass A": places}, 6.0)
    (low, high), centre = boxes["mass A"], at["mass A"]
    nearest = np.clip(centre, low, high)
    assert RADIUS * 0.8 < np.hypot(*(nearest - centre)) < 4 * RADIUS
    assert (np.abs(boxes["mass A"]) <= 3.0 + 0.05).all()


def test_names_of_stones_that_touch_do_not_lie_on_one_another():
    row = {f"stone {k}": (2 * RADIUS * k, 0.0) for k in range(3)}
    _, boxes = labelled(row, 6.0)
    for one, other in combinations(boxes.values(), 2):
        shared = np.minimum(one[1], other[1]) - np.maximum(one[0], other[0])
        assert shared.min() < 0.02


def test_a_name_keeps_off_a_path():
    free = labelled({"mass A": (0.0, 0.0)}, 6.0)[1]["mass A"]
    y = np.full(61, free.mean(axis=0)[1])
    moved = labelled({"mass A": (0.0, 0.0)}, 6.0, (np.linspace(0.2, 3, 61), y))[1]["mass A"]
    crossed = (moved[0, 1] < y[0] < moved[1, 1]) and moved[1, 0] > 0.2
    assert not crossed
