from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.clock import with_clock


@pytest.mark.parametrize("fps", [23.976, 29.97, 120.0])
def test_the_rounding_of_printed_times_goes(fps: float) -> None:
    exact = np.arange(90) / fps
    table, rate = with_clock(pd.DataFrame({"t": exact.round(3)}), [3])
    np.testing.assert_allclose(table["t"], exact, atol=3e-4)
    assert np.ptp(np.diff(table["t"])) < 1e-9
    assert rate == pytest.approx(fps, rel=2e-4)
    assert list(table["frame"]) == list(range(90))


def test_times_that_are_uneven_stay_and_have_no_frames() -> None:
    t = [0.0, 0.033, 0.1, 0.117, 0.2, 0.31]
    table, rate = with_clock(pd.DataFrame({"t": t}), [3])
    assert list(table["t"]) == t
    assert "frame" not in table
    assert rate == pytest.approx(1 / np.median(np.diff(t)))


def test_frames_that_are_there_stay() -> None:
    table, _ = with_clock(pd.DataFrame({"t": [0.0, 0.04, 0.08], "frame": [7, 8, 9]}), [None])
    assert list(table["frame"]) == [7, 8, 9]


@pytest.mark.parametrize("t", [[1.0], [0.0, np.nan], [0.0, 1e300]])
def test_of_one_time_or_of_nonsense_there_is_no_rate(t: list[float]) -> None:
    table, rate = with_clock(pd.DataFrame({"t": t}), [3])
    assert rate is None
    np.testing.assert_array_equal(table["t"], t)
