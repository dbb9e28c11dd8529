from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pandas as pd
import pytest
from matplotlib.patches import Circle

from curlshot.data.sheet import SHEET, STONE
from curlshot.physics.prediction.what_if import Amount, Changes
from curlshot.report.style import render
from curlshot.report.whatif import described, spread_figure
from curlshot.tests.helpers.report.drawn import check_layout


def outcomes(centre: tuple[float, float], count: int = 300) -> pd.DataFrame:
    rng = np.random.default_rng(0)
    a = pd.DataFrame(rng.normal(centre, 0.2, (count, 2)), columns=["x", "y"]).assign(stone="A")
    b = pd.DataFrame({"x": 0.5, "y": 0.5, "stone": "B"}, index=range(count))
    c = pd.DataFrame({"x": rng.normal(0, 9, count), "y": 1.0, "stone": "$C"})
    a, b, c = (
        table.assign(sample=np.arange(count), hits=hits) for table, hits in ((a, 1), (b, 0), (c, 1))
    )
    return pd.concat([a, b, c], ignore_index=True).assign(in_play=1)


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


def test_a_stone_that_hits_nothing_and_one_that_always_leaves_are_told_of() -> None:
    table = outcomes((0.0, 0.5))
    table.loc[table["stone"] == "A", "hits"] = 0
    table.loc[table["stone"] == "$C", "in_play"] = 0
    figure = spread_figure(table, {"A": (0, -5), "B": (0.5, 0.5), "$C": (0, 1)}, "A", "t")
    assert figure.axes[0].collections
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"median of A", r"\$C where hit (100% off the sheet)"} < {*labels}


def test_what_was_changed_is_said_in_words() -> None:
    changes = Changes(0.9, None, Amount(1.1, True), Amount(-1.5, False), -0.05)
    as_written = {name: value for name, value in asdict(changes).items() if value is not None}
    assert described(as_written) == [
        "e = 0.9", "speed × 1.1", "spin = −1.5 rad/s", "aimed 0.05 m to its right",
    ]  # fmt: skip


@pytest.mark.parametrize(("throws", "words"), [(1, []), (20, ["median of A"])])
def test_a_few_throws_are_dots(throws: int, words: list[str]) -> None:
    before = {"A": (0, -5), "B": (0.5, 0.5), "$C": (0, 1)}
    figure = spread_figure(outcomes((0, 0), throws), before, "A", "t")
    render(figure)
    assert not figure.axes[0].collections
    assert throws in [len(line.get_xydata()) for line in figure.axes[0].lines]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[: len(words) + 1] == ["where A ends", *words]


def test_a_house_is_drawn_where_there_is_one() -> None:
    before = {"A": (0.0, -0.2), "B": (0.1, 0.1), "$C": (0.0, 0.3)}
    circles = [
        sum(isinstance(patch, Circle) for patch in spread_figure(
            outcomes((0, 0)), before, "A", "t", house=house
        ).axes[0].patches)
        for house in (True, False)
    ]  # fmt: skip
    assert circles[0] - circles[1] == 4


def test_no_more_than_all_throws_end_on_a_place() -> None:
    table = outcomes((0.0, 0.5))
    table.loc[table["stone"] == "A", ["x", "y"]] = 0.02, 0.51
    before = {"A": (0.0, -5.0), "B": (0.5, 0.5), "$C": (0.0, 1.0)}
    ax = spread_figure(table, before, "A", "A thrown 300 times").axes[0]
    assert 50 < ax.collections[0].get_array().max() <= 100


def test_the_picture_leaves_no_room_for_what_ends_far_off() -> None:
    table = outcomes((0.0, 0.5))
    before = {"A": (0.0, -5.0), "B": (0.5, 0.5), "$C": (0.0, 1.0)}
    table.loc[table["stone"] == "$C", ["x", "y"]] = 4.0, -20.0
    ax = spread_figure(table, before, "A", "A thrown 300 times").axes[0]
    assert ax.get_xlim()[1] < 2.5 and ax.get_ylim()[1] < 2.5


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


def test_the_names_of_all_that_leave_the_sheet_are_in_the_picture() -> None:
    rng = np.random.default_rng(1)
    each, before = [], {}
    for k in range(6):
        stone = f"mass {k}"
        before[stone] = (0.8 * k - 2.0, 0.5)
        xy = rng.normal(before[stone], 0.2, (50, 2))
        each.append(pd.DataFrame(xy, columns=["x", "y"]).assign(stone=stone, sample=range(50)))
    table = pd.concat(each, ignore_index=True).assign(hits=1)
    table["in_play"] = (table["sample"] >= 20).astype(int)
    figure = spread_figure(table, before, "mass 0", "thrown 50 times")
    check_layout(figure)
    assert sum("40% off the sheet" in text.get_text() for text in figure.legends[0].texts) == 6


@pytest.mark.parametrize("play", [-1, 1])
def test_the_back_line_lies_behind_the_tee(play: int) -> None:
    before = {"A": (0.0, -5.0 * play), "B": (0.5, 0.5), "$C": (0.0, 1.0)}
    ax = spread_figure(outcomes((0, 0)), before, "A", "t", play=play).axes[0]
    across = [line.get_ydata()[0] for line in ax.lines if np.ptp(line.get_ydata()) == 0]
    assert SHEET.back_line * play in across
    assert -SHEET.back_line * play not in across


def test_long_names_stand_beside_their_stones() -> None:
    table = outcomes((0, 0)).replace({"stone": {"B": "Gelber Stein"}})
    before = {"A": (0.0, -5.0), "Gelber Stein": (0.5, 0.5), "$C": (0.0, 1.0)}
    figure = spread_figure(table, before, "A", "t")
    (name,) = (text for text in figure.axes[0].texts if text.get_text() == "Gelber Stein")
    assert np.hypot(*np.subtract(name.get_position(), before["Gelber Stein"])) > STONE.radius


def test_the_map_of_a_long_name_is_told_within_the_picture() -> None:
    name = "Gelber Stein der Mannschaft vom anderen Ufer des Sees"
    table = outcomes((0, 0)).replace({"stone": {"A": name}})
    figure = spread_figure(table, {name: (0, -5), "B": (0.5, 0.5), "$C": (0, 1)}, name, "t")
    check_layout(figure)
    assert "Mannschaft vom" not in figure.axes[1].get_ylabel()
