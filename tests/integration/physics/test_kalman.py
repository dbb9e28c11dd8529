from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.measurement import Duplicate
from curlshot.data.tracks import check_detections
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import HitCandidate, detect_hits
from curlshot.synthetic.physics import Start
from curlshot.tests.helpers.physics.kalman import errors
from curlshot.tests.helpers.physics.watch import RADIUS, airtable, hit_motion, watch


def test_angles_that_nobody_saw_are_empty(shared: Path) -> None:
    seen = airtable(shared)
    tracks = smooth(seen, detect_hits(seen, 0.035), radius=0.035)
    assert tracks[["theta", "omega", "sd_theta", "sd_omega"]].isna().all().all()
    assert tracks[["x", "vx", "sd_x", "sd_vx"]].notna().all().all()


def test_errors_are_as_large_as_stated() -> None:
    rng = np.random.default_rng(31)
    motion = hit_motion(1.2, 0.08, after=1.5)
    pulls = []
    for _ in range(12):
        seen = watch(motion, rng, sd=0.006)
        tracks = smooth(seen, detect_hits(seen, RADIUS), radius=RADIUS)
        off, sd = errors(tracks, motion)
        speed = np.hypot(*motion.at(tracks["t"].to_numpy())[:, 0, 3:5].T)
        beside = np.abs(tracks["t"] - motion.hits[0].t) < 0.01  # the hit itself may lie between
        moving = (tracks["stone"] == "A") | (tracks["t"] > motion.hits[0].t)
        pulls.append((off / sd)[moving & ~beside & (speed > 0.05)])
    square = np.mean(np.concatenate(pulls) ** 2, axis=0)
    # Normalised estimation error squared, 12 independent shots with some 5 free states each.
    assert np.all(square > 0.35)
    assert np.all(square < 1.6)
    covered = np.mean(np.abs(np.concatenate(pulls)) < 2, axis=0)
    assert np.all(covered > 0.88)


@pytest.mark.parametrize("speed", [0.5, 0.7, 2.0])
def test_slow_stones_are_slowed_more_on_real_ice(speed: float) -> None:
    """On ice that slows a stone by v^(-1/4) velocities are as good at the ends as is stated."""
    rng = np.random.default_rng(2)
    t = np.arange(0, 3.0, 0.04)
    stop = speed**1.25 / 0.125
    left = 1 - t / stop
    y, vy = speed * stop / 1.8 * (1 - left**1.8), speed * left**0.8
    pulls = []
    for _ in range(8):
        table = pd.DataFrame({"stone": "A", "frame": np.arange(len(t)), "t": t})
        table["x"], table["y"] = rng.normal(0, 0.003, len(t)), rng.normal(y, 0.003)
        tracks = smooth(check_detections(table.assign(sd_x=0.003, sd_y=0.003)), (), radius=RADIUS)
        off = np.column_stack([(tracks["y"] - y) / tracks["sd_y"], tracks["vy"] - vy])
        off[:, 1] /= tracks["sd_vy"]
        pulls.append(off[[0, -1]])
    assert np.all(np.mean(np.square(pulls), axis=0) < 2)


def test_duplicates_of_the_last_frame_have_states_too() -> None:
    motion = hit_motion(1.0, 0.05)
    seen = watch(motion, np.random.default_rng(8), sd=0.002)
    hits = detect_hits(seen, RADIUS)
    without = smooth(seen, hits, radius=RADIUS)
    last, t = int(seen["frame"].max()), float(seen["t"].max())
    # The second repeats the first, and the third another frame than the last.
    held = {last + k: Duplicate(t + 0.04 * k, last + (k > 1)) for k in (1, 2)}
    other = {last + 3: Duplicate(t + 0.12, last - 1)}
    tracks = smooth(seen, hits, radius=RADIUS, duplicates=held | other)
    added = tracks[tracks["frame"] > last]
    assert added.groupby("stone")["frame"].agg(list).tolist() == [[last + 1, last + 2]] * 2
    assert (added["seen"] == 0).all()
    before = tracks[tracks["frame"] <= last].reset_index(drop=True)
    pd.testing.assert_frame_equal(before, without, rtol=1e-6, atol=1e-9)
    for _, rows in tracks.groupby("stone"):
        final, *later = rows[["t", "x", "y", "vx", "vy", "sd_y"]].to_numpy()[-3:]
        for row in later:
            moved = (row[0] - final[0]) * final[3:5]
            np.testing.assert_allclose(row[1:3], final[1:3] + moved, atol=0.001)
            assert row[5] >= final[5]


def test_a_way_too_short_to_be_seen_twice_is_told_by_its_ends() -> None:
    motion = hit_motion(1.8, 0.0, after=1.0, others=[Start(0.03, 2 * RADIUS + 0.07)])
    first, second = motion.hits
    middle = (first.t + second.t) / 2
    for detections in (0, 1):
        pulls = []
        for seed in range(8):
            rng = np.random.default_rng([37, seed])
            seen = watch(motion, rng, fps=100, sd=0.001)
            near = seen["t"].between(first.t, second.t) & (seen["stone"] == "B")
            kept = (seen.loc[near, "t"] - middle).abs().nsmallest(detections).index
            left = seen.drop(seen.index[near].difference(kept)).reset_index(drop=True)
            contacts = [
                HitCandidate(hit.t + rng.normal(0, 5e-4), 5e-4, stones, hit.normal)
                for hit, stones in ((first, ("A", "B")), (second, ("B", "C")))
            ]
            tracks = smooth(left, contacts, radius=RADIUS)
            own = tracks[tracks["stone"] == "B"]
            row = own.iloc[(own["t"] - middle).abs().argmin()]
            true = motion.at(row["t"])[1]
            pulls += [(row[v] - true[k]) / row[f"sd_{v}"] for k, v in ((3, "vx"), (4, "vy"))]
            assert row["sd_vy"] < 0.1
            assert row["y"] == pytest.approx(true[1], abs=4 * row["sd_y"])
        assert np.mean(np.abs(pulls) < 2) > 0.8


@pytest.mark.parametrize("stone", ["A", "B"])
@pytest.mark.parametrize("since", [0.0, 1.0])
def test_a_slip_that_a_way_begins_with_is_refused(stone: str, since: float) -> None:
    """The first of all detections, and the first after the hit: the next ones are believed."""
    motion = hit_motion(1.5, 0.05)
    seen = watch(motion, np.random.default_rng(38), sd=0.002)
    first = seen.index[(seen["stone"] == stone) & (seen["t"] > since)][0]
    seen.loc[first, "x"] += 0.3
    tracks = smooth(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    own = tracks[tracks["stone"] == stone]
    assert own["t"][own["seen"] == 0].tolist() == [seen.loc[first, "t"]]
    off, _ = errors(tracks, motion)
    assert np.abs(off[:, :2]).max() < 0.01
