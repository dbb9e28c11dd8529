from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.local_fit.traces import (
    CORRELATION_LENGTH,
    local_residuals,
    shared_correlation,
    traces,
)
from curlshot.tests.helpers.physics.watch import hit_motion, uncut, watch


def test_noise_is_estimated_where_it_is_not_given() -> None:
    rng = np.random.default_rng(51)
    for sd in (0.002, 0.01):
        seen = watch(hit_motion(), rng, sd=sd, sd_theta=0.05, given=False)
        for trace in traces(seen).values():
            assert np.allclose(trace.sd, sd, rtol=0.35)
            assert np.allclose(trace.sd_theta, 0.05, rtol=0.35)


def test_a_stone_that_rests_long_says_nothing_of_the_noise_of_one_that_goes_on() -> None:
    seen = uncut(hit_motion(), (100.0, 0.0), sd=0.004, at_rest=0.0005, given=False)
    trace = traces(seen)["B"]
    assert np.allclose(trace.sd[trace.t < 0], 0.0005, rtol=0.2)
    assert np.allclose(trace.sd[trace.t > 1.5], 0.004, rtol=0.35)


def test_given_errors_are_believed_unless_too_small() -> None:
    seen = watch(hit_motion(), np.random.default_rng(52), sd=0.004)
    modest = seen.assign(sd_x=0.008, sd_y=0.008)
    assert np.allclose(traces(modest)["A"].sd, 0.008)
    boastful = seen.assign(sd_x=0.001, sd_y=0.001)
    assert np.allclose(traces(boastful)["A"].sd, 0.004, rtol=0.35)


def test_white_residuals_keep_their_size_on_a_parabola() -> None:
    rng = np.random.default_rng(53)
    t = np.sort(rng.uniform(0, 20, 4000))
    values = (1 + 2 * t - 0.3 * t**2)[:, None] + rng.normal(0, 0.01, (4000, 1))
    assert np.std(local_residuals(t, values)) == pytest.approx(0.01, rel=0.05)
    assert local_residuals(t[:4], values[:4]).shape == (0, 1)


def test_a_gap_is_as_long_as_the_stone_was_not_seen_at_a_time() -> None:
    seen = watch(hit_motion(), np.random.default_rng(55))
    hidden = seen[(seen["t"] < 0.5) | (seen["t"] > 0.9)]
    trace = traces(hidden)["A"]
    assert trace.gap(0.7) == pytest.approx(0.4, abs=2 / 30)
    assert trace.gap(0.3) == pytest.approx(1 / 30)


def test_angles_are_made_continuous() -> None:
    seen = watch(hit_motion(), np.random.default_rng(54))
    turning = seen["stone"] == "A"
    seen.loc[turning, "theta"] = np.angle(np.exp(1j * 3.0 * seen.loc[turning, "t"]))
    theta = traces(seen)["A"].theta
    assert np.allclose(np.diff(theta), 3.0 / 30, atol=1e-9)


def test_what_places_share_fades_with_their_distance() -> None:
    shared = shared_correlation(
        np.array([[0.0, 0.0], [0.6, 0.8], [30.0, 0.0]]) * CORRELATION_LENGTH
    )
    assert np.diag(shared) == pytest.approx(1.0)
    assert shared[0, 1] == shared[1, 0] == pytest.approx(np.exp(-0.5))
    assert shared[0, 2] < 1e-12


def test_what_places_share_is_half_another_60_cm_on() -> None:
    """As errors of stones under way in clips whose truth is known, rendered and semi-real."""
    xy = np.array([[0.0, 0.0], [0.6, 0.0]])
    assert shared_correlation(xy)[0, 1] == pytest.approx(0.5, abs=0.05)
