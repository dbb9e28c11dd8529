from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.measurement import Duplicate
from curlshot.data.tracks import TRACK_COLUMNS, check_detections
from curlshot.physics.filter import reference_filter as reference
from curlshot.physics.filter.rate_filter import filtered
from curlshot.physics.filter.stretch import Filter
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import HitCandidate, detect_hits
from curlshot.tests.helpers.physics.kalman import errors
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def test_smoothing_is_better_than_looking() -> None:
    motion = hit_motion(1.2, 0.08, after=1.5)
    seen = watch(motion, np.random.default_rng(32), sd=0.006)
    tracks = smooth(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    off, _ = errors(tracks, motion)
    far = np.abs(tracks["t"] - motion.hits[0].t) > 0.05
    assert np.sqrt(np.mean(off[far, :2] ** 2)) < 0.003
    assert np.sqrt(np.mean(off[far, 3:5] ** 2)) < 0.012
    assert np.sqrt(np.mean(off[far, 5] ** 2)) < 0.05


def test_nothing_leaks_across_a_hit() -> None:
    motion = hit_motion()
    seen = watch(motion, np.random.default_rng(33))
    hits = detect_hits(seen, RADIUS)
    whole = smooth(seen, hits, radius=RADIUS)
    late = seen["t"] > hits[0].t
    other = seen.copy()
    other.loc[late, ["x", "y"]] += 0.05 * np.sin(10 * other.loc[late, ["t"]].to_numpy())
    changed = smooth(other, hits, radius=RADIUS)
    before = whole["t"] < hits[0].t
    after = whole[~before][["vx", "vy"]].to_numpy() - changed[~before][["vx", "vy"]].to_numpy()
    assert np.abs(after).max() > 0.05
    for column in ("x", "y", "vx", "vy"):
        shift = np.abs(whole[before][column] - changed[before][column])
        # Only what the deceleration and the noise of the whole shot say can differ.
        assert shift.max() < 0.02
    jump = whole[~before & (whole["stone"] == "B")].iloc[0]
    assert np.hypot(jump["vx"], jump["vy"]) > 1.0


def test_a_row_that_may_lie_on_the_other_side_of_a_hit_says_so() -> None:
    motion = hit_motion()
    seen = watch(motion, np.random.default_rng(42))
    frame = seen["t"].unique()[np.searchsorted(seen["t"].unique(), motion.hits[0].t)]
    sure, unsure = (
        smooth(
            seen,
            [HitCandidate(frame - 0.001, error, ("A", "B"), motion.hits[0].normal)],
            radius=RADIUS,
        )
        for error in (1e-5, 1e-3)
    )
    beside = (sure["t"] == frame) & (sure["stone"] == "A")
    before = (sure["t"] < frame) & (sure["stone"] == "A")
    jump = sure["vy"][beside].item() - sure["vy"][before].iloc[-1]
    # It lies one standard error of the time after the hit: before it with a probability of 0.159.
    assert unsure["sd_vy"][beside].item() == pytest.approx(
        np.hypot(sure["sd_vy"][beside].item(), np.sqrt(0.159 * 0.841) * jump), rel=0.01
    )
    assert unsure["sd_vy"][before].iloc[-2] == pytest.approx(sure["sd_vy"][before].iloc[-2])


def test_an_angle_seen_beside_a_hit_is_kept_whatever_becomes_of_the_spin() -> None:
    t = np.arange(60) / 25
    turned = 9.0 * np.minimum(t - 1.0, 0.0) - 9.0 * np.maximum(t - 1.0, 0.0)
    seen = pd.DataFrame({"stone": "A", "t": t, "x": 0.0, "y": np.minimum(t - 1.0, 0.0)})
    seen = check_detections(seen.assign(theta=turned, sd_x=0.002, sd_y=0.002, sd_theta=0.01))
    tracks = smooth(seen, [HitCandidate(1.0, 0.005, ("A", "B"), (0.0, 1.0))], radius=RADIUS)
    assert np.abs(tracks["theta"] - turned).max() < 0.05
    beside = tracks["omega"][t == 1.0].item(), tracks["sd_omega"][t == 1.0].item()
    assert beside[0] == pytest.approx(-9.0, abs=0.5)
    assert beside[1] == pytest.approx(9.0, rel=0.05)  # half of what the hit changed


def test_a_stone_at_rest_stays_at_rest() -> None:
    motion = hit_motion()
    seen = watch(motion, np.random.default_rng(34))
    hits = detect_hits(seen, RADIUS)
    tracks = smooth(seen, hits, radius=RADIUS)
    resting = tracks[(tracks["stone"] == "B") & (tracks["t"] < hits[0].t)]
    assert (resting[["vx", "vy", "omega"]] == 0).all().all()
    assert np.ptp(resting["x"]) < 1e-3
    assert np.hypot(resting["x"], resting["y"]).max() < 0.004


def test_a_stone_stopped_dead_was_as_fast_until_then() -> None:
    pulls = []
    for seed in range(10):
        rng = np.random.default_rng([41, seed])
        t = np.arange(60) / 25
        stop = t[35] + 0.04 * rng.random()
        y = 1.1 * np.minimum(t, stop) - 1.1 * stop
        seen = check_detections(
            pd.DataFrame(
                {
                    "stone": "A",
                    "frame": np.arange(60),
                    "t": t,
                    "x": rng.normal(0, 0.0005, 60),
                    "y": y + rng.normal(0, 0.0005, 60),
                    "sd_x": 0.0005,
                    "sd_y": 0.0005,
                }
            )
        )
        tracks = smooth(seen, (), radius=RADIUS)
        moving = tracks[(t < stop) & (t > 0.5)]
        pulls.append((moving["vy"] - 1.1) / moving["sd_vy"])
    assert np.mean(np.abs(np.concatenate(pulls)) < 2) > 0.9


def test_gaps_are_bridged_and_marked() -> None:
    rng = np.random.default_rng(35)
    motion = hit_motion()
    seen = watch(motion, rng, fps=50)
    dropped = seen["frame"].isin(rng.choice(150, 40, replace=False))
    hidden = (seen["stone"] == "A") & seen["t"].between(0.4, 0.7)
    left = seen[~dropped & ~hidden].reset_index(drop=True)
    tracks = smooth(left, detect_hits(left, RADIUS), radius=RADIUS)
    assert tuple(tracks.columns) == TRACK_COLUMNS
    carried = tracks[tracks["seen"] == 0]
    assert set(carried["stone"]) == {"A"}
    assert carried["t"].between(0.4, 0.7).all()
    assert len(carried) == (~dropped & hidden).sum()
    off, sd = errors(tracks, motion)
    gap = (tracks["seen"] == 0).to_numpy()
    assert np.abs(off[gap, :2]).max() < 0.01
    assert sd[gap, 0].max() > 1.15 * np.median(sd[~gap & (tracks["stone"] == "A"), 0])


def test_frames_in_which_nothing_was_measured_have_states_where_they_are_wanted() -> None:
    motion = hit_motion(1.0, 0.05)
    seen = watch(motion, np.random.default_rng(8), sd=0.002)
    hits = detect_hits(seen, RADIUS)
    without = smooth(seen, hits, radius=RADIUS)
    t = float(seen["t"].iloc[10]) + 0.005
    tracks = smooth(seen, hits, radius=RADIUS, duplicates={9999: Duplicate(t, 10)})
    added = tracks["frame"] == 9999
    off, sd = errors(tracks[added], motion)
    assert len(off) == 2 and (tracks["seen"][added] == 0).all() and (tracks["t"][added] == t).all()
    assert np.all(np.abs(off[:, :2]) < 5 * sd[:, :2])
    kept = tracks[~added].reset_index(drop=True)
    assert np.allclose(kept[["x", "y"]], without[["x", "y"]], atol=1e-5)


def test_outliers_are_refused() -> None:
    rng = np.random.default_rng(36)
    motion = hit_motion()
    seen = watch(motion, rng)
    wild = rng.choice(np.flatnonzero(seen["t"] > 0.3), 5, replace=False)
    bad = seen.copy()
    bad.loc[wild, "x"] += 0.3
    tracks = smooth(bad, detect_hits(bad, RADIUS), radius=RADIUS)
    keys = pd.MultiIndex.from_frame(bad.loc[wild, ["stone", "frame"]])
    refused = tracks.set_index(["stone", "frame"]).loc[keys, "seen"]
    assert (refused == 0).all()
    off, _ = errors(tracks, motion)
    assert np.abs(off[:, :2]).max() < 0.03


def test_a_spin_is_seen_through_missing_angles() -> None:
    motion = hit_motion(stone_friction=0.2)
    seen = watch(motion, np.random.default_rng(37))
    seen.loc[seen["frame"] % 3 == 0, ["theta", "sd_theta"]] = np.nan
    tracks = smooth(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    off, _ = errors(tracks, motion)
    assert np.abs(off[:, 5]).max() < 0.3
    late = tracks[(tracks["stone"] == "B") & tracks["t"].between(1.3, 2.0)]["omega"]
    assert late.mean() == pytest.approx(motion.hits[0].after[1][2], abs=0.05)


def test_small_and_empty_tables() -> None:
    seen = watch(hit_motion(), np.random.default_rng(38))
    assert smooth(seen.iloc[:0], (), radius=RADIUS).empty
    one = smooth(seen.iloc[:1], (), radius=RADIUS)
    assert len(one) == 1
    assert one["x"].iloc[0] == pytest.approx(seen["x"].iloc[0])
    two = smooth(seen.groupby("stone").head(2).reset_index(drop=True), (), radius=RADIUS)
    assert len(two) == 4
    assert np.isfinite(two[["x", "y", "vx", "vy"]].to_numpy()).all()


def test_what_detections_share_is_not_averaged_out() -> None:
    t = np.arange(50) / 25
    table = pd.DataFrame({"stone": "A", "frame": np.arange(50), "t": t, "x": 1.0, "y": 0.0})
    table = table.assign(theta=np.nan, sd_x=0.002, sd_y=0.002, sd_theta=np.nan)
    table = table.assign(sd_place_x=0.003, sd_place_y=0.006)
    tracks = smooth(check_detections(table), (), radius=0.1455)
    assert (tracks["sd_x"].between(0.003, 0.0036)).all()
    assert (tracks["sd_y"].between(0.006, 0.0064)).all()
    far = table.assign(sd_place_x=0.003 * (1 + np.arange(50)))
    tracks = smooth(check_detections(far), (), radius=0.1455)
    assert tracks["sd_x"].to_numpy() == pytest.approx(far["sd_place_x"].to_numpy(), abs=0.0006)


def test_what_places_share_does_not_turn_the_line_on_which_stones_hit() -> None:
    """Velocities tell spins of poorly seen handles as well wherever all of it happens."""
    seen = watch(hit_motion(), np.random.default_rng(5), sd=0.001, sd_theta=0.3)
    hits = detect_hits(seen, RADIUS)
    alike = seen.assign(sd_place_x=0.006, sd_place_y=0.006)
    sure, shared = (smooth(table, hits, radius=RADIUS) for table in (seen, alike))
    turning = sure["sd_omega"] > 0.05
    assert turning.sum() > 20
    assert (shared["sd_omega"] < 1.1 * sure["sd_omega"])[turning].all()


@pytest.mark.parametrize("run", [filtered, reference.filtered])
def test_a_stone_at_rest_that_was_moved_unseen_lies_where_it_is_seen(run: Filter) -> None:
    """Between its two places nobody knows where it is, and the errors say so."""
    rng = np.random.default_rng(5)
    t = np.arange(0, 4, 1 / 30)
    y = 0.85 - 0.19 * np.clip((t - 1.1) / 0.35, 0, 1)
    table = pd.DataFrame({"stone": "B", "frame": np.arange(len(t)), "t": t, "x": 0.07, "y": y})
    table[["x", "y"]] += rng.normal(0, 0.001, (len(t), 2))
    hidden = (t > 1.05) & (t < 1.55)
    table = table[~hidden]
    unseen = {int(k): Duplicate(float(t[k]), -1) for k in np.flatnonzero(hidden)}
    tracks = smooth(check_detections(table), (), radius=RADIUS, run=run, duplicates=unseen)
    off, sd = (tracks["y"] - y).to_numpy(), tracks["sd_y"].to_numpy()
    assert np.abs(off[~hidden]).max() < 0.001
    assert (tracks["seen"] == ~hidden).all()
    assert (np.abs(off) < 2 * sd + 1e-4)[hidden].all()
    assert sd[hidden].min() > 0.03 and sd[~hidden].max() < 0.001
    assert (tracks.loc[hidden, "sd_vy"] > 0.3).all()


def stopped(hidden: tuple[float, float], **columns: np.ndarray) -> tuple[pd.DataFrame, np.ndarray]:
    """B glides 0.8 m, turning, and lies there from 4 s on; other columns instead. Second when."""
    rng = np.random.default_rng(0)
    t = np.arange(0, 9, 1 / 25)
    glided = np.minimum(t, 4.0)
    table = pd.DataFrame({"stone": "B", "frame": np.arange(len(t)), "t": t, "x": 0.0})
    table["y"], table["theta"] = 0.4 * glided - 0.05 * glided**2, 0.5 * glided
    table = table.assign(**{name: table[name] + more for name, more in columns.items()})
    table[["x", "y"]] += rng.normal(0, 0.001, (len(t), 2))
    table["theta"] += rng.normal(0, 0.01, len(t))
    return table[(t < hidden[0]) | (t > hidden[1])], t[(t >= hidden[0]) & (t <= hidden[1])]


@pytest.mark.parametrize("run", [filtered, reference.filtered])
def test_a_stone_that_stops_unseen_and_is_hit_later_was_not_moved(run: Filter) -> None:
    """Its rest is kept apart from its glide, for a hit ends it, but at the same place."""
    t = np.arange(0, 9, 1 / 25)
    table, when = stopped((3.6, 4.6), x=1.4 * np.maximum(t - 7, 0))
    hitting = pd.DataFrame({"stone": "A", "frame": np.arange(len(t)), "t": t, "y": 0.8})
    hitting["x"] = np.where(t < 7, 1.5, 0.1) * (t - 7) - 2 * RADIUS
    detections = check_detections(pd.concat([hitting, table]))
    contacts = [HitCandidate(7.0, 0.001, ("A", "B"), (1.0, 0.0))]
    unseen = {round(25 * at): Duplicate(float(at), -1) for at in when}
    tracks = smooth(detections, contacts, radius=RADIUS, run=run, duplicates=unseen)
    b = tracks[(tracks["stone"] == "B") & tracks["t"].between(3.6, 4.6)]
    assert (np.abs(b["y"] - 0.8 + 0.05 * np.maximum(4 - b["t"], 0) ** 2) < 0.003).all()
    assert b["omega"].notna().all()
    assert (b.loc[b["t"] > 4.2, ["vy", "omega"]] == 0).all(axis=None)


@pytest.mark.parametrize("run", [filtered, reference.filtered])
def test_a_stone_that_stopped_and_was_turned_unseen_did_not_spin_before(run: Filter) -> None:
    later = (np.arange(0, 9, 1 / 25) > 6).astype(float)
    table, when = stopped((5.8, 6.4), y=0.3 * later, theta=2.5 * later)
    unseen = {round(25 * at): Duplicate(float(at), -1) for at in when}
    tracks = smooth(check_detections(table), (), radius=RADIUS, run=run, duplicates=unseen)
    before = tracks[tracks["t"].between(5.0, 5.79)]
    assert (np.abs(before["omega"]) < 3 * before["sd_omega"]).all()
    assert np.abs(tracks.loc[tracks["t"] > 6.41, "theta"] - 4.5).max() < 0.02
    meanwhile = tracks.loc[tracks["seen"] == 0, ["theta", "omega", "sd_theta", "sd_omega"]]
    assert len(meanwhile) == len(when) and meanwhile.isna().all(axis=None)


@pytest.mark.parametrize("run", [filtered, reference.filtered])
def test_a_stray_where_a_moved_stone_comes_back_has_no_say(run: Filter) -> None:
    """It lies elsewhere from there on: the filter believed the stray and refused the others."""
    later = (np.arange(0, 9, 1 / 25) > 6).astype(float)
    table, _ = stopped((5.8, 6.4), y=0.3 * later)
    back = table["t"].gt(6.4).idxmax()
    table.loc[back, "y"] -= 0.15
    tracks = smooth(check_detections(table), (), radius=RADIUS, run=run)
    after = tracks[tracks["t"] > 6.5]
    assert (after["seen"] == 1).all()
    assert (np.abs(after["y"] - 1.1) < 0.0005).all()
