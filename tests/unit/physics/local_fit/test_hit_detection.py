from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.watch import (
    RADIUS,
    hit_motion,
    watch,
)


def test_a_stone_that_stops_at_once_hides_no_hit() -> None:
    # The first stone goes on at 1 cm/s. Sought from three frames before on, a fit had it at rest
    # before it hit, and no error bounded how fast it may have been.
    motion = simulate(
        [Start(-0.03, -1.296, 0, 0.638), Start(0, 0)],
        3.84,
        ice=Ice(b=0.01),
        impact=Impact(0.93, 0.04),
        step=5e-4,
        keep_every=4,
    )
    seen = watch(motion, np.random.default_rng(35), fps=25, sd=0.01)
    (hit,) = detect_hits(seen, RADIUS)
    assert abs(hit.t - motion.hits[0].t) < 3 * hit.stderr_t


def test_a_push_and_a_wall_are_no_hits() -> None:
    rng = np.random.default_rng(5)
    t = np.arange(0, 3, 1 / 30)
    # At rest, pushed at 1 s, back from a wall at 2 s; another stone rests 0.5 m beside.
    y = np.where(t < 1, 0, np.where(t < 2, t - 1, 1 - 0.7 * (t - 2)))
    pushed = pd.DataFrame({"stone": "A", "t": t, "x": 0.0, "y": y})
    rest = pd.DataFrame({"stone": "B", "t": t, "x": 0.5, "y": 0.5})
    table = pd.concat([pushed, rest], ignore_index=True)
    table["frame"] = np.round(table["t"] * 30).astype(int)
    table[["theta", "sd_x", "sd_y", "sd_theta"]] = np.nan
    table[["x", "y"]] += rng.normal(0, 0.003, (len(table), 2))
    assert detect_hits(table, RADIUS) == ()


def test_hit_behind_a_broom_is_found_from_the_paths_beside_it() -> None:
    rng = np.random.default_rng(6)
    motion = hit_motion()
    seen = watch(motion, rng)
    hidden = (np.abs(seen["t"] - motion.hits[0].t) < 0.15) & (seen["stone"] == "A")
    (hit,) = detect_hits(seen[~hidden].reset_index(drop=True), RADIUS)
    assert hit.t == pytest.approx(motion.hits[0].t, abs=0.03)


def test_a_hit_that_goes_on_through_a_touching_stone_out_of_sight_is_both_hits() -> None:
    """The stone that comes and the last one never come near each other."""
    beyond = Start(0.08, 2 * RADIUS * 0.97)
    motion = hit_motion(2.6, 0.08, before=0.9, after=1.4, others=[beyond])
    assert [(hit.first, hit.second) for hit in motion.hits] == [(0, 1), (1, 2)]
    seen = watch(motion, np.random.default_rng(7), fps=25.0, sd=0.004)
    since = seen["t"] - motion.hits[0].t
    hits = detect_hits(seen[(since < -0.1) | (since > 0.2)].reset_index(drop=True), RADIUS)
    assert [set(hit.stones) for hit in hits] == [{"A", "B"}, {"B", "C"}]


def test_a_near_miss_out_of_sight_is_no_hit() -> None:
    starts = [Start(0.32, -2.0, 0.0, 1.25, 0.3, 1.0), Start(0.0, 0.0)]
    motion = simulate(starts, 4.0, ice=Ice(b=0.0109), impact=Impact(), step=5e-4, keep_every=4)
    seen = watch(motion, np.random.default_rng(5), sd=0.002)
    passing = seen["t"].between(1.4, 2.0)
    assert detect_hits(seen[~passing].reset_index(drop=True), RADIUS) == ()


@pytest.mark.parametrize("until", [0.16, 0.35])
def test_hit_of_a_stone_long_out_of_sight_is_where_the_other_starts(until: float) -> None:
    rng = np.random.default_rng(8)
    motion = hit_motion(0.9, before=2.2)
    seen, t = watch(motion, rng, sd=0.0005), motion.hits[0].t
    hidden = (seen["stone"] == "A") & (seen["t"] > t - 1.9) & (seen["t"] < t + until)
    (hit,) = detect_hits(seen[~hidden].reset_index(drop=True), RADIUS)
    assert hit.stones == ("A", "B")
    assert hit.t == pytest.approx(t, abs=0.01)


def test_few_or_lonely_detections_have_no_hits() -> None:
    seen = watch(hit_motion(), np.random.default_rng(8))
    assert detect_hits(seen[seen["stone"] == "A"].reset_index(drop=True), RADIUS) == ()
    assert detect_hits(seen.iloc[:1], RADIUS) == ()
    assert detect_hits(seen.iloc[:0], RADIUS) == ()
    assert detect_hits(seen.groupby("stone").head(2).reset_index(drop=True), RADIUS) == ()
