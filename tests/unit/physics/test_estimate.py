from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.data.results import Estimate
from curlshot.data.tracks import check_detections
from curlshot.physics.estimate import _of_two, _times, estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.estimate import CASES, measure, repeated
from curlshot.tests.helpers.physics.watch import (
    RADIUS,
    hit_motion,
    watch,
)


@pytest.mark.parametrize("case", CASES)
def test_errors_of_the_states_mean_what_they_say(case: tuple[float, float, float, bool]) -> None:
    motion, found = repeated(*case)
    true, pulls, sd = motion.hits[0], [], case[0]
    for one in found:
        (hit,) = one.collisions
        for name, before, after in zip("AB", true.before, true.after, strict=True):
            for state, values in ((hit.before[name], before), (hit.after[name], after)):
                if np.hypot(*values[:2]) > 0:
                    off = np.array([state.vx, state.vy, state.omega], float) - values
                    pulls.append(off / [state.sd_vx, state.sd_vy, state.sd_omega])
                assert state.sd_x is not None
                assert 0.05 * sd < state.sd_x < sd
    for each in np.std(pulls, axis=0):
        assert 0.45 < each < 1.4
    assert np.mean(np.abs(pulls) < 2) > 0.9


def test_unequal_masses() -> None:
    # A heavy stone seen in a mirror of momentum: equal stones' truth must not fit.
    motion = hit_motion(1.5, 0.05)
    seen = watch(motion, np.random.default_rng(17), sd=0.002)
    hits = detect_hits(seen, RADIUS)
    wrong = estimate(seen, hits, radius=RADIUS, masses={"A": 1.0, "B": 2.0}).collisions[0]
    right = estimate(seen, hits, radius=RADIUS, masses={"A": 3.0, "B": 3.0}).collisions[0]
    assert right.momentum_residual is not None
    assert wrong.momentum_residual is not None
    assert right.momentum_residual < 0.03
    assert wrong.momentum_residual > 0.5


def test_outliers_do_not_decide() -> None:
    rng = np.random.default_rng(18)
    seen = watch(hit_motion(), rng, sd=0.003)
    wild = rng.choice(len(seen), 8, replace=False)
    seen.loc[wild, ["x", "y"]] += rng.uniform(-0.4, 0.4, (8, 2))
    found = measure(seen)
    assert found.restitution.value == pytest.approx(0.83, abs=0.03)
    assert found.friction.value == pytest.approx(0.0109, rel=0.1)


def test_uneven_times_and_gaps() -> None:
    rng = np.random.default_rng(19)
    seen = watch(hit_motion(), rng, sd=0.003, fps=60)
    kept = seen[seen["frame"].isin(rng.choice(180, 90, replace=False))]
    gap = kept[~((kept["stone"] == "B") & kept["t"].between(1.3, 1.8))].reset_index(drop=True)
    found = measure(gap)
    assert found.restitution.value == pytest.approx(0.83, abs=0.03)
    assert found.friction.value == pytest.approx(0.0109, rel=0.1)


def test_what_cannot_be_told_is_none_and_said() -> None:
    seen = watch(hit_motion(), np.random.default_rng(20))
    alone = measure(seen[seen["stone"] == "A"].reset_index(drop=True))
    assert alone.restitution.value is None
    assert any("no hit" in warning for warning in alone.warnings)
    still = measure(seen[(seen["stone"] == "B") & (seen["t"] < 0.9)].reset_index(drop=True))
    assert still.restitution.value is None
    assert still.friction.value is None
    assert still.warnings
    hits = detect_hits(seen, RADIUS)
    short = seen[seen["t"] < hits[0].t].reset_index(drop=True)
    cut = estimate(short, hits, radius=RADIUS)
    assert cut.collisions[0].restitution is None
    assert "seen" in (cut.collisions[0].note or "")
    assert cut.restitution.value is None


def test_no_detections_at_all() -> None:
    seen = watch(hit_motion(), np.random.default_rng(21)).iloc[:0]
    assert measure(seen).collisions == ()
    assert measure(seen).warnings


def test_columns_that_a_table_lacks_are_as_good_as_empty_ones() -> None:
    bare = watch(hit_motion(), np.random.default_rng(23))[["stone", "t", "x", "y"]]
    full = check_detections(bare)
    hits = detect_hits(bare, RADIUS)
    assert len(hits) == 1
    assert hits == detect_hits(full, RADIUS)
    assert estimate(bare, hits, radius=RADIUS) == estimate(full, hits, radius=RADIUS)
    tracks = [smooth(table, hits, radius=RADIUS) for table in (bare, full)]
    pd.testing.assert_frame_equal(*tracks)


def test_result_is_the_same_each_time_and_for_any_name() -> None:
    seen = watch(hit_motion(), np.random.default_rng(22))
    one, two = measure(seen), measure(seen)
    assert one == two
    renamed = seen.assign(stone=seen["stone"].map({"A": "yellow", "B": "Red 2"}))
    other = measure(renamed.sort_values(["stone", "t"]).reset_index(drop=True))
    assert other.restitution.value == pytest.approx(one.restitution.value, abs=1e-4)
    assert other.collisions[0].stones == ("yellow", "Red 2")
    assert replace(one.collisions[0], stones=("x", "y")).t == pytest.approx(
        other.collisions[0].t, abs=1e-4
    )


def test_errors_that_places_share_are_in_that_of_restitution() -> None:
    scores = []
    for seed in range(6):
        rng = np.random.default_rng(200 + seed)
        seen = watch(hit_motion(1.2, 0.08), rng, sd=0.001)
        # A map of the ice that is wrong by 3 mm, now this way, now that, alike over a metre.
        x, y = seen["x"].to_numpy(), seen["y"].to_numpy()
        for axis, first, second in (("x", x, y), ("y", y, x)):
            wave = np.sin(first + rng.uniform(0, 6)) * np.sin(second + rng.uniform(0, 6))
            seen[axis] += 0.006 * wave
        if seed == 0:
            alone = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).restitution
        seen[["sd_place_x", "sd_place_y"]] = 0.003
        found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).restitution
        assert found.value is not None
        assert found.stderr is not None
        assert alone.stderr is not None
        assert alone.stderr < found.stderr < 0.04
        scores.append((found.value - 0.83) / found.stderr)
    assert np.sqrt(np.mean(np.square(scores))) < 1.5


def test_ice_that_slows_slow_stones_more_does_not_bias_restitution() -> None:
    errors = []
    for seed in range(6):
        rng = np.random.default_rng(400 + seed)
        starts = [
            Start(rng.uniform(0.03, 0.2), -1.2, 0, rng.uniform(0.7, 1.6), 0.3, 1.0),
            Start(0, 0),
        ]
        fcv1 = Ice(a=0.00201, b=0.00626, v_c=0.0639)
        motion = simulate(starts, 2.6, ice=fcv1, impact=Impact(0.83), step=5e-4, keep_every=4)
        seen = watch(motion, rng, sd=0.003)
        hit = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).collisions[0]
        assert hit.restitution is not None
        assert hit.stderr is not None
        errors.append((hit.restitution - 0.83, hit.stderr))
    off, stderr = np.array(errors).T
    assert abs(off.mean()) < 2 * np.sqrt(np.sum(stderr**2)) / len(off)
    assert np.sqrt(np.mean((off / stderr) ** 2)) < 1.5


@pytest.mark.parametrize(
    ("gain", "whys"),
    [(0.15, ["gain speed"]), (0.8, ["glides freely", "A is apparently pushed or carried"])],
)
def test_stones_that_gain_speed_have_no_friction(gain: float, whys: list[str]) -> None:
    t = np.arange(60) / 30
    table = pd.DataFrame({"stone": "A", "frame": np.arange(60), "t": t, "x": 0.0})
    table["y"] = 0.5 * t + 0.5 * gain * t**2
    table = table.assign(sd_x=0.002, sd_y=0.002)
    found = estimate(check_detections(table), (), radius=0.1455)
    assert found.friction.value is None
    for why in whys:
        assert any(why in text for text in found.warnings)


def test_a_stone_that_is_pushed_on_its_way_to_the_hit() -> None:
    seen = watch(hit_motion(1.5, 0.08), np.random.default_rng(12), sd=0.001)
    early = (seen["stone"] == "A") & (seen["t"] < 0.6)
    seen.loc[early, "y"] += 0.5 * (0.6 - seen.loc[early, "t"])
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is None
    assert found.restitution.value == pytest.approx(0.83, abs=0.02)
    (why,) = [text for text in found.warnings if "shot fit" in text]
    assert "something other than ice and hits moves a stone" in why
    assert found.methods["shot_fit"].note == why
    for name in ("local", "finite-differences"):
        assert "friction between the stones" in str(found.methods[name].stone_friction.note)


def test_what_two_ways_differ_by_is_in_the_error() -> None:
    """Both scatter about their mean as they should with a variance (d² - s1² - s2²) / 2 more."""
    local = Estimate(0.82, 0.01)
    found = _of_two(local, Estimate(0.88, 0.004))
    assert found.value == 0.82
    more = (0.06**2 - 0.01**2 - 0.004**2) / 2
    assert found.stderr == pytest.approx(np.sqrt(0.01**2 + more), rel=1e-6)
    assert _of_two(local, Estimate(0.825, 0.004)) == local
    assert _of_two(local, Estimate()) == local


@pytest.mark.parametrize(
    ("size", "told"), [(2.16, "2.2"), (9.96, "10"), (14.4, "14"), (46705.4, "47000")]
)
def test_a_misfit_is_written_as_exactly_as_it_is_known(size: float, told: str) -> None:
    assert _times(size) == told
