from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.physics.local_fit.breaks import breaks
from curlshot.physics.local_fit.off_centre import centred
from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import Trace
from curlshot.tests.helpers.physics.off_centre import (
    AHEAD,
    FPS,
    LEFT,
    T,
    glide,
    seen,
    wobble,
)
from curlshot.tests.helpers.physics.watch import RADIUS


def beside(trace: Trace) -> Trace:
    return replace(trace, xy=trace.xy + wobble(trace.theta))


def cut_at(trace: Trace) -> list[float]:
    return breaks(trace.t, trace.xy, trace.sd, trace.lasting)


@pytest.mark.parametrize("seed", range(5))
def test_a_cap_that_goes_round_is_taken_out_and_no_break_of_the_glide(seed: int) -> None:
    truth = glide(T)
    trace = beside(seen(truth, seed=seed))
    over = centred({"A": trace}, [], RADIUS)["A"]
    assert len(cut_at(trace)) > 0
    assert cut_at(over) == []
    assert np.sqrt(np.mean((trace.xy - truth) ** 2)) > 0.003
    assert np.sqrt(np.mean((over.xy - truth) ** 2)) < 0.0012


def test_it_is_taken_out_however_little_places_err_together() -> None:
    truth = glide(T)
    trace = beside(seen(truth, place=0.0008))
    over = centred({"A": trace}, [], RADIUS)["A"]
    assert np.sqrt(np.mean((over.xy - truth) ** 2)) < 0.0012


def test_it_is_told_from_before_and_after_a_hit_together() -> None:
    at = 2.5
    after = np.maximum(T - at, 0)[:, None] * [0.5, -0.4]
    truth = glide(T) + after
    trace = beside(seen(truth, omega=2.5))
    hit = Meeting(at, ("A", "B"), 1 / FPS)
    over = centred({"A": trace}, [hit], RADIUS)["A"]
    assert np.sqrt(np.mean((over.xy - truth) ** 2)) < 0.0012


def test_a_stone_that_stops_is_told_by_its_way_until_then() -> None:
    t = np.arange(0, 15, 1 / FPS)
    truth, stop = glide(t, 0.5), 0.5 / 0.09
    trace = seen(truth)
    trace = beside(replace(trace, theta=1.6 * np.minimum(trace.t, stop)))
    over = centred({"A": trace}, [], RADIUS)["A"]
    assert np.sqrt(np.mean((over.xy - truth) ** 2)) < 0.0012


def test_a_push_is_no_cap_beside_the_centre() -> None:
    pushed = glide(T) + np.maximum(T - 2, 0)[:, None] * [0.0, 0.15]
    trace = seen(pushed)
    over = centred({"A": trace}, [], RADIUS)["A"]
    assert over is trace
    assert cut_at(over) == pytest.approx([2], abs=0.2)


def test_a_push_of_a_stone_with_its_cap_beside_the_centre_stays_where_it_is() -> None:
    pushed = glide(T) + np.maximum(T - 2.5, 0)[:, None] * [0.0, 0.25]
    over = centred({"A": beside(seen(pushed))}, [], RADIUS)["A"]
    assert cut_at(over) == pytest.approx([2.5], abs=0.2)


@pytest.mark.parametrize("half", [slice(0, 75), slice(75, None)])
def test_where_the_angle_is_not_told_for_long_nothing_is_taken_out(half: slice) -> None:
    trace = beside(seen(glide(T)))
    trace.theta[half] = np.nan
    assert centred({"A": trace}, [], RADIUS)["A"] is trace


def test_where_the_angle_is_not_told_in_between_nothing_is_taken_out_either() -> None:
    trace = beside(seen(glide(T)))
    trace.theta[60:95] = np.nan
    assert centred({"A": trace}, [], RADIUS)["A"] is trace


def test_what_lies_farther_out_than_a_cap_may_is_none() -> None:
    trace = seen(glide(T))
    far = replace(trace, xy=trace.xy + 3 * wobble(trace.theta))
    assert centred({"A": far}, [], RADIUS)["A"] is far


def test_hits_of_other_stones_cut_no_way() -> None:
    trace = beside(seen(glide(T)))
    hits = [Meeting(at, ("B", "C"), 1 / FPS) for at in np.arange(0.3, 5, 0.3).tolist()]
    over = centred({"A": trace}, hits, RADIUS)["A"]
    np.testing.assert_array_equal(over.xy, centred({"A": trace}, [], RADIUS)["A"].xy)


def test_places_far_off_do_not_tell_of_the_cap() -> None:
    truth = glide(T)
    trace = beside(seen(truth))
    trace.xy[::9] += 0.03
    over = centred({"A": trace}, [], RADIUS)["A"]
    good = np.arange(len(T)) % 9 > 0
    assert np.sqrt(np.mean((over.xy - truth)[good] ** 2)) < 0.0012


def test_places_far_off_that_go_round_with_the_stone_do_not_tell_of_it_either() -> None:
    """As where something else is taken for the cap now and then: weights are told in rounds."""
    truth = glide(T)
    trace = beside(seen(truth))
    trace.xy[::9] += 6 * (wobble(trace.theta) @ np.array([[0.0, 1.0], [-1.0, 0.0]]))[::9]
    over = centred({"A": trace}, [], RADIUS)["A"]
    good = np.arange(len(T)) % 9 > 0
    assert np.sqrt(np.mean((over.xy - truth)[good] ** 2)) < 0.001


def test_no_path_is_fitted_of_a_stone_that_hardly_turns() -> None:
    """It would tell nothing: most stones of a clip lie still."""
    trace = seen(glide(T), omega=0.38)
    assert centred({"A": trace}, [], RADIUS)["A"] is trace


def test_what_the_angle_is_off_by_is_in_the_errors() -> None:
    trace = beside(seen(glide(T)))
    over = centred({"A": trace}, [], RADIUS)["A"]
    expected = np.hypot(trace.sd, 0.02 * np.hypot(AHEAD, LEFT))
    assert over.sd == pytest.approx(expected, rel=0.05)


def test_angles_that_are_told_by_those_beside_them_err_as_these_do() -> None:
    trace = beside(seen(glide(T)))
    trace.sd_theta[:] = 0.2
    trace.theta[1::2] = trace.sd_theta[1::2] = np.nan
    over = centred({"A": trace}, [], RADIUS)["A"]
    assert over.sd.min() > 1.5 * trace.sd.max()
    assert over.sd[1::2] == pytest.approx(over.sd[::2])


@pytest.mark.parametrize(
    "trace",
    [
        seen(glide(T), place=0.0),
        seen(glide(T), omega=0.3),
        replace(seen(glide(T)), theta=np.full(len(T), np.nan)),
    ],
    ids=["no error that is shared", "hardly turning", "no angles"],
)
def test_what_tells_nothing_of_its_cap_stays_as_it_is(trace: Trace) -> None:
    moved = replace(trace, xy=trace.xy + wobble(0.4 + 1.6 * trace.t))
    assert centred({"A": moved}, [], RADIUS)["A"] is moved
