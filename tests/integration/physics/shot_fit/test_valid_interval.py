"""Shots of which the tracks or the simulator have a hit that the other has not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import ObservedShot
from curlshot.physics.shot_fit.valid_interval import fit_valid_interval
from curlshot.synthetic.physics import Start
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


def seen_with_late_touch() -> pd.DataFrame:
    """A hits B at 1 s; 2.5 s later A hits C too."""
    motion = hit_motion(1.8, 0.2, before=1.0, after=3.0, others=[Start(2.1, 1.995)])
    assert [sorted((hit.first, hit.second)) for hit in motion.hits] == [[0, 1], [0, 2]]
    return watch(motion, np.random.default_rng(3), sd=0.003)


def measure(seen: pd.DataFrame, without: int = 0) -> Estimates:
    contacts = detect_hits(seen, RADIUS)
    return estimate(seen, contacts[: len(contacts) - without], radius=RADIUS)


def near(found: Estimates) -> bool:
    e = found.restitution
    assert e.value is not None
    assert e.stderr is not None
    return abs(e.value - 0.83) < 3 * e.stderr


def test_a_shot_is_followed_up_to_a_hit_that_was_not_seen() -> None:
    seen = seen_with_late_touch()
    every, fewer = measure(seen), measure(seen, without=1)
    assert every.shot_fit is not None
    assert not [text for text in every.warnings if "reproduces" in text]
    assert fewer.shot_fit is not None
    (text,) = [text for text in fewer.warnings if "reproduces" in text]
    assert "the hit of A and C differs from the simulated one" in text
    end = max(float(trace.t[-1]) for trace in fewer.shot_fit.shots[0].traces.values())
    assert end < every.collisions[-1].t
    assert near(every)
    assert near(fewer)
    # Sharper than the paths beside the hit, all the same.
    assert (fewer.restitution.stderr or 1) < (fewer.local.restitution.stderr or 0)


def test_a_first_hit_that_is_not_as_simulated_leaves_the_values_beside_it() -> None:
    seen = seen_with_late_touch()
    contacts = detect_hits(seen, RADIUS)
    # C is said to be hit by B, which never comes near it.
    wrong = [replace(contacts[0], stones=("B", "C")), *contacts[1:]]
    found = estimate(seen, wrong, radius=RADIUS)
    assert found.shot_fit is None
    assert any("does not reproduce" in text or "differ" in text for text in found.warnings)


def test_a_fit_that_does_not_settle_is_left_before_its_last_hit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = measure(seen_with_late_touch()).shot_fit
    assert whole is not None
    (shot,) = whole.shots

    def fit(part: ObservedShot) -> ShotFit:
        return replace(whole, shots=(part,), settled=part is not shot)

    for name in ("fit_with_chosen_laws", "fit_without_bent_tracks"):
        monkeypatch.setattr(f"curlshot.physics.shot_fit.valid_interval.{name}", fit)
    found, end = fit_valid_interval(shot)
    assert found.shots[0].hits == shot.hits[:1]
    assert (
        end
        == f"until {shot.times[-1] - 0.1:.2f} s: the fit does not converge with the hit of A and C"
    )


def test_places_that_slip_as_a_stone_comes_into_view_do_not_set_it_in_motion() -> None:
    """In the blend of two views a stone at rest seems to move, faster than ice lets it stop."""
    seen = watch(hit_motion(1.5, 0.1), np.random.default_rng(4), sd=0.001)
    early = (seen["stone"] == "B") & (seen["t"] < 0.15)
    seen.loc[early, "x"] -= 0.25 * (0.15 - seen.loc[early, "t"])
    found = measure(seen)
    assert found.shot_fit is not None
    assert "B.vx" not in found.shot_fit.names
    assert near(found)


def test_hits_at_one_time_may_come_in_another_order() -> None:
    seen = seen_with_late_touch()
    whole = measure(seen).shot_fit
    assert whole is not None
    shot, run = whole.shots[0], whole.simulation()
    (first, last), pairs = shot.times, shot.hits
    assert shot.first_other_hit(run) is None
    swapped = {"hits": pairs[::-1], "times": (last - 0.01, last)}
    assert replace(shot, **swapped).first_other_hit(run) is None
    assert replace(shot, hits=pairs[::-1]).first_other_hit(run) == (first, "A and C")
    assert replace(shot, hits=pairs[:1], times=(first,)).first_other_hit(run) == (
        run.hits[1].t + shot.start, "A and C"
    )  # fmt: skip
    more = replace(shot, hits=(*pairs, ("B", "C")), times=(first, last, last + 1))
    assert more.first_other_hit(run) == (last + 1, "B and C")


@pytest.mark.parametrize(("map_sd", "left"), [(0.0, True), (0.002, False)])
def test_a_map_that_errs_makes_a_longer_part_noisier_and_ends_no_shot(
    map_sd: float, left: bool
) -> None:
    """Where stated errors of the map hold what differs, all that was seen is one shot."""
    seen = watch(hit_motion(), np.random.default_rng(4), sd=0.0003)
    later = seen["t"] > 2.0
    seen.loc[later, ["x", "y"]] += 0.002 * np.sin(4 * seen.loc[later, ["t", "t"]].to_numpy())
    seen = seen[~((seen["t"] > 1.8) & (seen["t"] < 2.2))].reset_index(drop=True)
    seen = seen.assign(sd_place_x=map_sd, sd_place_y=map_sd)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert any("does not continue the same motion" in text for text in found.warnings) == left


@pytest.mark.parametrize("lost", [0.0, 0.02])
def test_a_shot_is_left_where_the_clip_has_lost_time(lost: float) -> None:
    seen = watch(hit_motion(), np.random.default_rng(4), sd=0.0005)
    away = (seen["t"] > 1.8) & (seen["t"] < 2.2)
    seen = seen[~away].reset_index(drop=True)
    seen.loc[seen["t"] > 2.0, "t"] -= lost
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    assert any("does not continue the same motion" in text for text in found.warnings) == (lost > 0)
    assert found.friction.stderr is not None
    assert abs(float(found.friction.value or 0) - 0.0109) < 3 * found.friction.stderr
