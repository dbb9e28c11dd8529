from __future__ import annotations

import pytest
from matplotlib.patches import Circle

from curlshot.report.style import render
from curlshot.report.whatif import spread_figure
from curlshot.tests.helpers.report.drawn import check_layout
from curlshot.tests.helpers.report.whatif import outcomes


@pytest.mark.parametrize("centre", [(0.0, 0.5), (1.0, 30.0)])
def test_the_heat_map_shows_where_the_thrown_stone_ends(centre: tuple[float, float]) -> None:
    before = {"A": (0.0, -5.0), "B": (0.5, 0.5), "$C": (0.0, 1.0)}
    figure = spread_figure(outcomes(centre), before, "A", "A thrown 300 times")
    render(figure)
    ax = figure.axes[0]
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    assert left < centre[0] < right and bottom < centre[1] < top
    assert right - left < 14 and top - bottom < 14
    heat = ax.collections[0].get_array()
    assert heat is not None
    # The map's cells of 5 cm × 5 cm, as shares on 10 cm × 10 cm, make up the whole.
    assert float(heat.sum()) / 4 == pytest.approx(100, abs=10)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    # B is never hit; what lies out of view has no entry.
    at_home = ["before the shot", r"\$C where hit"] if centre[1] < 10 else []
    assert labels == ["median of A", *at_home]
    drawn = [patch.center for patch in ax.patches if isinstance(patch, Circle)]
    assert (0.5, 0.5) in drawn and (0.0, -5.0) not in drawn


@pytest.mark.parametrize(("throws", "words"), [(1, []), (20, ["median of A"])])
def test_a_few_throws_are_dots(throws: int, words: list[str]) -> None:
    before = {"A": (0, -5), "B": (0.5, 0.5), "$C": (0, 1)}
    figure = spread_figure(outcomes((0, 0), throws), before, "A", "t")
    render(figure)
    assert not figure.axes[0].collections
    assert throws in [len(line.get_xydata()) for line in figure.axes[0].lines]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[: len(words) + 1] == ["where A ends", *words]


@pytest.mark.parametrize("off", [0.4, 1.0])
def test_stones_that_leave_the_sheet_are_counted_not_drawn_where_they_leave_it(off: float) -> None:
    table, before = outcomes((0.0, 0.5)), {"A": (0.0, -5.0), "B": (0.5, 0.5), "$C": (0.0, 1.0)}
    gone = (table["stone"] == "A") & (table["sample"] < 300 * off)
    table.loc[gone, ["x", "y", "in_play"]] = [2.2, 0.1, 0]
    figure = spread_figure(table, before, "A", "A thrown 300 times")
    render(figure)
    ax, labels = figure.axes[0], [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[0] == ("median of A (40% off the sheet)", "A always leaves the sheet")[off == 1]
    if off == 1.0:
        assert not ax.collections
        return
    heat = ax.collections[0].get_array()
    assert heat is not None
    assert float(heat.sum()) / 4 == pytest.approx(100 * (1 - off), abs=10)
    across = ax.collections[0].get_coordinates()[0, :-1, 0]
    assert not heat[:, across > 1.5].any()


def test_the_map_of_a_long_name_is_told_within_the_picture() -> None:
    name = "Gelber Stein der Mannschaft vom anderen Ufer des Sees"
    table = outcomes((0, 0)).replace({"stone": {"A": name}})
    figure = spread_figure(table, {name: (0, -5), "B": (0.5, 0.5), "$C": (0, 1)}, name, "t")
    check_layout(figure)
    assert "Mannschaft vom" not in figure.axes[1].get_ylabel()
