from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.results import Estimate, SimulationScore
from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.replay import simulate_measured
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, semireal, watch

MODELS = {"point-mass", "rigid-body", "frictional"}


def again(
    seen: pd.DataFrame,
) -> tuple[dict[str, pd.DataFrame], dict[str, SimulationScore], tuple[str, ...]]:
    hits = detect_hits(seen, RADIUS)
    tracks = smooth(seen, hits, radius=RADIUS)
    done = simulate_measured(tracks, estimate(seen, hits, radius=RADIUS), radius=RADIUS)
    return done.samples, done.scores, done.warnings


def test_the_shot_again_lands_where_it_did() -> None:
    seen = watch(hit_motion(1.2, 0.08), np.random.default_rng(41), sd=0.002)
    samples, scores, warnings = again(seen)
    assert set(scores) == MODELS
    assert scores["frictional"].rmse is not None
    assert scores["frictional"].rmse < 0.02
    assert set(scores["frictional"].rest_error) == {"A", "B"}
    assert max(float(v or 0) for v in scores["frictional"].rest_error.values()) < 0.04
    for stone, error in scores["frictional"].rest_error.items():
        sd = scores["frictional"].rest_sd[stone]
        assert sd is not None
        assert 0.25 * (error or 0.0) < sd < 0.1
    assert warnings == ()
    table = samples["frictional"]
    hit = detect_hits(seen, RADIUS)[0].t
    assert table["t"].min() < hit < table["t"].min() + 0.04
    assert set(table["frame"]) <= set(seen["frame"])


def test_stones_meet_where_the_tracks_have_them_meet() -> None:
    """Tracks 3 % too small: two radii are too far apart for where the stones were seen to hit."""
    seen = watch(hit_motion(1.5, 0.15), np.random.default_rng(48), sd=0.001)
    seen[["x", "y"]] *= 0.97
    hits = detect_hits(seen, RADIUS)
    found = estimate(seen, hits, radius=RADIUS)
    assert found.joint_estimate is not None
    size = found.joint_estimate.values[found.joint_estimate.names.index("size")]
    assert size == pytest.approx(0.97, abs=0.006)

    def farthest(of: Estimates) -> float:
        tracks = smooth(seen, hits, radius=RADIUS)
        score = simulate_measured(tracks, of, radius=RADIUS).scores["frictional"]
        return max(error or 0.0 for error in score.rest_error.values())

    # All but the size is told by the paths beside the hit too.
    assert farthest(found) < 0.5 * farthest(replace(found, shot_fit=None))


def test_a_frame_that_may_lie_behind_the_hit_is_no_start() -> None:
    # The tracks are cut at the contact; the fit's time of the same hit may be just behind a frame.
    seen = watch(hit_motion(1.5, 0.1), np.random.default_rng(44), sd=0.004)
    (contact,) = detect_hits(seen, RADIUS)
    tracks = smooth(seen, (contact,), radius=RADIUS)
    found = estimate(seen, (contact,), radius=RADIUS)
    frame = float(tracks["t"][tracks["t"] >= contact.t].min())
    late = replace(found.collisions[0], t=frame + 1e-5, stderr_t=frame - contact.t)
    found = replace(found, collisions=(late,))
    scores = simulate_measured(tracks, found, radius=RADIUS).scores
    assert [hit.stones for hit in scores["frictional"].hits] == [("A", "B")]


def test_the_error_of_the_last_place_is_of_where_a_stone_was_last_seen() -> None:
    seen = watch(hit_motion(1.5, 0.1, after=3.0), np.random.default_rng(46))
    seen = seen[(seen["stone"] == "A") | (seen["t"] < 1.6)].reset_index(drop=True)
    samples, scores, _ = again(seen)
    table = samples["frictional"].set_index(["stone", "frame"])
    last = seen[seen["stone"] == "B"]["frame"].max()
    there = table.loc[("B", last), ["sd_x", "sd_y"]].to_numpy(float)
    assert scores["frictional"].rest_sd["B"] == pytest.approx(np.hypot(*there))


def test_who_glides_only_is_no_part_of_the_score() -> None:
    seen = watch(hit_motion(), np.random.default_rng(42))
    early = seen[seen["t"] < 0.9].reset_index(drop=True)
    samples, scores, warnings = again(early)
    assert any("no hit" in warning for warning in warnings)
    assert scores["point-mass"].rmse is not None
    assert scores["point-mass"].rmse < 0.02
    assert set(scores["point-mass"].rest_error) == {"A"}
    assert set(samples) == MODELS


def test_a_glide_that_comes_into_view_late_is_simulated_from_there() -> None:
    """Taken back to the first frame at its speed then it would lack what ice had slowed."""
    seen = watch(hit_motion(), np.random.default_rng(42))
    seen = seen[seen["t"] < 0.9]
    late = seen[(seen["stone"] != "A") | (seen["t"] > 0.4)].reset_index(drop=True)
    samples, scores, _ = again(late)
    assert samples["frictional"]["t"].min() == late.loc[late["stone"] == "A", "t"].min()
    assert scores["frictional"].rmse is not None
    assert scores["frictional"].rmse < 0.006


def test_without_spins_the_rigid_bodies_say_so() -> None:
    seen = watch(hit_motion(), np.random.default_rng(43))
    seen[["theta", "sd_theta"]] = np.nan
    samples, scores, _ = again(seen)
    assert scores["rigid-body"].rmse is None
    assert "spin" in (scores["rigid-body"].note or "")
    assert "rigid-body" not in samples
    assert scores["frictional"].rmse is not None


def test_two_hits_in_quick_succession(shared: Path) -> None:
    seen = semireal(shared, "pyeongchang_two_hits", np.random.default_rng(44), sd=0.005)
    _, scores, _ = again(seen)
    assert scores["frictional"].rmse is not None
    assert scores["frictional"].rmse < 0.06
    assert set(scores["frictional"].rest_error) == {"A", "B", "C"}


def test_what_is_seen_after_the_hit_does_not_move_the_start_without_a_fit_of_the_whole() -> None:
    motion = hit_motion()
    seen = watch(motion, np.random.default_rng(45))
    hits = detect_hits(seen, RADIUS)
    found = estimate(seen, hits, radius=RADIUS)
    tracks = smooth(seen, hits, radius=RADIUS)
    other = tracks.copy()
    other.loc[other["t"] > hits[0].t, ["x", "y"]] += 0.5
    alone = replace(found, shot_fit=None)
    one, two = (simulate_measured(t, alone, radius=RADIUS).samples for t in (tracks, other))
    pd.testing.assert_frame_equal(one["frictional"], two["frictional"])
    start = one["frictional"].groupby("stone")[["x", "y"]].first()
    last = tracks[tracks["t"] < hits[0].t].groupby("stone")[["x", "y"]].last()
    np.testing.assert_allclose(start, last, atol=1e-9)


def test_stones_that_grip_each_other_are_simulated_so() -> None:
    # Much friction: the slip ends within the contact.
    seen = watch(hit_motion(1.4, -0.12, stone_friction=0.4), np.random.default_rng(47), sd=0.002)
    estimates = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert estimates.collisions[0].stone_friction is None
    _, scores, _ = again(seen)
    point_mass, frictional = scores["point-mass"].rmse, scores["frictional"].rmse
    assert frictional is not None
    assert point_mass is not None
    assert frictional < min(0.02, 0.5 * point_mass)
    assert "as in the shot fit" in (scores["frictional"].note or "")
    local = replace(estimates, shot_fit=None)
    tracks = smooth(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    scores = simulate_measured(tracks, local, radius=RADIUS).scores
    assert "at least" in (scores["frictional"].note or "")


def test_what_the_fit_of_the_whole_shot_tells_is_not_said_to_be_assumed() -> None:
    seen = watch(hit_motion(1.2, 0.08), np.random.default_rng(41), sd=0.002)
    hits = detect_hits(seen, RADIUS)
    tracks = smooth(seen, hits, radius=RADIUS)
    found = replace(estimate(seen, hits, radius=RADIUS), restitution=Estimate())
    assert found.shot_fit is not None
    e = found.shot_fit["restitution"].value or 0.0
    done = simulate_measured(tracks, found, radius=RADIUS)
    said = f"simulation: restitution not measured: {e:.2g}, as in the shot fit"
    assert done.warnings == (said,)
    done = simulate_measured(tracks, replace(found, shot_fit=None), radius=RADIUS)
    assert done.warnings == ("simulation: restitution not measured, 0.83 assumed",)


def test_a_stone_counts_beyond_where_it_was_hidden() -> None:
    """Ice takes .13 m/s of it in 1.2 s, and nothing else does."""
    seen = watch(hit_motion(1.5, 0.05, after=3.0), np.random.default_rng(52), sd=0.001)
    hidden = (seen["stone"] == "B") & seen["t"].between(1.6, 2.8)
    _, scores, warnings = again(seen[~hidden].reset_index(drop=True))
    assert warnings == ()
    assert set(scores["frictional"].rest_error) == {"A", "B"}


def test_a_stone_counts_until_something_else_moves_it() -> None:
    seen = watch(hit_motion(1.2, 0.08), np.random.default_rng(48), sd=0.002)
    hit = detect_hits(seen, RADIUS)[0].t
    b = seen["stone"] == "B"
    wall = hit + 0.8
    k = seen[b & (seen["t"] >= wall)].index
    seen.loc[k, "y"] = 2 * seen.loc[k[0], "y"] - seen.loc[k, "y"]
    _, scores, warnings = again(seen)
    assert any("B is compared until" in warning for warning in warnings)
    assert scores["frictional"].rmse is not None
    assert scores["frictional"].rmse < 0.02
    assert set(scores["frictional"].rest_error) == {"A"}


def test_empty_tracks() -> None:
    seen = watch(hit_motion(), np.random.default_rng(46)).iloc[:0]
    samples, scores, warnings = again(seen)
    assert samples == {}
    assert scores == {}
    assert warnings == pytest.approx(("no tracks to simulate",))
