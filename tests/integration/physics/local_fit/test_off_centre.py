from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.physics.local_fit.off_centre import centred
from curlshot.tests.helpers.physics.off_centre import (
    FPS,
    T,
    glide,
    seen,
    wobble,
)
from curlshot.tests.helpers.physics.watch import RADIUS


@pytest.mark.parametrize("slowing", [0.0, 0.09, 0.2])
def test_a_stone_whose_cap_is_in_the_middle_stays_as_it_is(slowing: float) -> None:
    for seed in range(10):
        trace = seen(glide(T, 1.1, slowing + 1e-9), seed=seed)
        assert centred({"A": trace}, [], RADIUS)["A"] is trace


@pytest.mark.parametrize(("end", "omega"), [(0.1, 0.3), (0.1, 0.5), (0.35, 0.7), (0.5, 0.5)])
def test_a_long_way_that_curls_the_more_the_slower_is_no_cap(end: float, omega: float) -> None:
    t = np.arange(0, 20, 1 / FPS)
    speed, heading = 2 - 0.09 * t, end * (t / 20) ** 3
    steps = speed[:, None] * np.column_stack([np.sin(heading), np.cos(heading)]) / FPS
    way = np.cumsum(steps, axis=0)
    for seed in range(3):
        trace = seen(way, omega=omega, seed=seed)
        assert centred({"A": trace}, [], RADIUS)["A"] is trace


def test_a_cap_that_shows_by_two_or_three_errors_stays_where_it_is() -> None:
    for seed in range(20):
        trace = seen(glide(T), seed=seed)
        near = replace(trace, xy=trace.xy + 0.4 * wobble(trace.theta))
        assert centred({"A": near}, [], RADIUS)["A"] is near
