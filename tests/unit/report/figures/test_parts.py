from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from curlshot.report import figures
from curlshot.report.figures import parts
from curlshot.tests.helpers.report.drawn import check_layout


def test_close_hits_share_a_label(shot):
    hit = shot.results.collisions[0]
    hits = [dataclasses.replace(hit, t=t) for t in (0.8, 0.81, 0.83, 4.0, 6.0, 6.02)]
    figure = figures.speed_figure(shot.tracks, hits)
    check_layout(figure)
    assert [t.get_text() for t in figure.axes[0].texts] == ["1–3", "4", "5, 6"]


def test_a_line_breaks_in_long_gaps_and_at_cuts():
    t = np.array([0.0, 0.1, 0.2, 1.0, 1.1, 1.2])
    times, values = parts.broken(t, 10 * t, cuts=[1.15])
    gaps = np.flatnonzero(np.isnan(times))
    assert gaps.tolist() == [3, 6]
    assert np.isnan(values[gaps]).all()
    np.testing.assert_array_equal(np.delete(times, gaps), t)
    (alone,) = parts.broken(np.array([2.0]))
    assert alone.tolist() == [2.0]


def test_the_error_of_a_speed_is_that_along_its_velocity():
    speed, sd = parts.magnitude(*np.array([[3.0, 0.0], [4.0, 0.0], [0.1, 0.1], [0.2, 0.2]]))
    assert speed.tolist() == [5.0, 0.0]
    assert sd == pytest.approx([np.hypot(0.6 * 0.1, 0.8 * 0.2), 0.2])


def test_long_names_stand_as_numbers_in_stones():
    assert parts.symbols(["A", "B2"]) == {"A": "A", "B2": "B2"}
    assert parts.symbols(["A", "mass B"]) == {"A": "1", "mass B": "2"}
    assert parts.short("a" * 16) == "a" * 16
    assert parts.short("a" * 17) == "a" * 15 + "…"


def test_a_stone_at_rest_has_no_number():
    assert parts.said(0.0, 0.01, rest=True) == "at rest"
    assert parts.said(0.8312345, 0.0123456) == "0.831 ± 0.012"
    assert parts.said(0.8312345, None) == "0.831"
