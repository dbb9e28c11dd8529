from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pandas as pd
import pytest
from matplotlib.patches import Circle

from curlshot.data.sheet import SHEET, STONE
from curlshot.physics.prediction.what_if import Amount, Changes
from curlshot.report.whatif import described, spread_figure
from curlshot.tests.helpers.report.drawn import check_layout
from curlshot.tests.helpers.report.whatif import outcomes


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
