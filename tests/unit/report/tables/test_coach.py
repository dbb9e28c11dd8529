from __future__ import annotations

import numpy as np
import pytest

from curlshot.data.sheet import SHEET
from curlshot.report import tables
from curlshot.tests.helpers.report.glides import MU_G, glide


def test_speeds_at_the_lines_are_those_of_the_closed_form():
    tracks = glide("A", (0.3, 8.0), 1.6)
    table = tables.speed_table(tracks, ()).set_index("at")
    for at, y in (("hog line", SHEET.hog_line), ("tee line", 0.0)):
        speed = np.sqrt(1.6**2 - 2 * MU_G * (8.0 - y))
        assert table.loc[at, "speed"] == pytest.approx(speed, abs=1e-3)
        assert table.loc[at, "t"] == pytest.approx((1.6 - speed) / MU_G, abs=0.01)
        assert table.loc[at, "sd"] == pytest.approx(0.003, rel=0.01)
    assert table["note"].isna().all()


def test_a_line_that_was_not_passed_in_view_has_a_reason():
    table = tables.speed_table(glide("A", (0.3, 4.0), 0.8), ()).set_index("at")
    assert table["speed"].isna().all()
    assert table.loc["hog line", "note"] == "first detected 2.4 m past it"
    way = 0.8**2 / (2 * MU_G)
    assert table.loc["tee line", "note"].startswith(f"came no closer than {4.0 - way:.1f} m")


def test_stones_from_the_other_end_pass_the_other_hog_line():
    tracks = glide("A", (0.0, 8.0), 1.6)
    tracks[["y", "vy"]] *= -1
    assert tables.speed_table(tracks, ())["speed"].notna().all()


def test_takeouts_tell_what_was_lost(shot):
    table = tables.takeout_table(shot.results.collisions)
    hit = shot.results.collisions[0]
    arrived, left = (np.hypot(s["A"].vx, s["A"].vy) for s in (hit.before, hit.after))
    row = table.iloc[0]
    assert (row["arrived"], row["left"]) == pytest.approx((arrived, left))
    assert row["share"] == pytest.approx(1 - left / arrived)
    assert 0.012 < row["sd_lost"] < 0.022
    assert row["struck"] == pytest.approx(np.hypot(hit.after["B"].vx, hit.after["B"].vy))
