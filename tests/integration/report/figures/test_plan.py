from __future__ import annotations

import numpy as np
import pytest
from matplotlib.patches import Circle
from matplotlib.text import Annotation

from curlshot.data.sheet import HOUSE
from curlshot.report import figures
from curlshot.report.figures.parts import rows_of
from curlshot.tests.helpers.report.drawn import check_layout


@pytest.mark.parametrize("house", [HOUSE, None])
def test_plan_shows_every_stone_to_scale(shot, house):
    figure = figures.plan_figure(
        shot.tracks, shot.simulations, shot.results.collisions, house=house
    )
    check_layout(figure)
    (ax,) = figure.axes
    assert {"A", "B", "C", "D"} <= {t.get_text() for t in ax.texts}
    radii = [round(p.get_radius(), 4) for p in ax.patches if isinstance(p, Circle)]
    assert radii.count(0.1455) == 4 + 9
    assert radii.count(1.829) == (house is not None)
    assert ax.get_aspect() == 1


def test_plan_of_stones_that_were_seen_once(shot):
    one = shot.tracks[shot.tracks["frame"] == 0]
    check_layout(figures.plan_figure(one, house=HOUSE))
    check_layout(figures.plan_figure(one, house=None))


def test_a_stone_last_seen_under_way_is_shown_with_its_simulations_at_that_time(shot):
    tracks, gone = shot.tracks, 2.0
    left = tracks[(tracks["stone"] != "C") | (tracks["t"] <= gone)]
    stopped = tracks.assign(vx=tracks["vx"].where(tracks["t"] < 6, 0.0))
    stopped["vy"] = tracks["vy"].where(tracks["t"] < 6, 0.0)
    for table, arrows in ((stopped, 0), (left, 1)):
        figure = figures.plan_figure(table, shot.simulations, house=HOUSE)
        check_layout(figure)
        (ax,) = figure.axes
        drawn = [item for item in ax.texts if isinstance(item, Annotation)]
        assert len(drawn) == arrows
        said = [text.get_text() for text in figure.legends[0].get_texts()]
        assert ("last detected, moving" in said) == bool(arrows)
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    (arrow,) = drawn
    assert (low < arrow.xy).all() and (arrow.xy < high).all()  # else it would not be drawn
    velocity = rows_of(left, "C")[["vx", "vy"]].to_numpy(float)[-1]
    way = np.subtract(arrow.xy, arrow.xyann)
    assert way[0] * velocity[1] - way[1] * velocity[0] == pytest.approx(0, abs=1e-9)
    circles = [p.center for p in ax.patches if isinstance(p, Circle)]
    for simulated in shot.simulations.values():
        rows = rows_of(simulated, "C")
        then = rows.loc[rows["t"] <= gone, ["x", "y"]].to_numpy(float)[-1]
        at_last = rows[["x", "y"]].to_numpy(float)[-1]
        apart = (
            np.hypot(*(np.array(circles) - then).T).min(),
            np.hypot(*(np.array(circles) - at_last).T).min(),
        )
        assert apart[0] < 1e-9 < 0.1 < apart[1]
