from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import pytest

from curlshot.data.results import Estimate
from curlshot.physics.filter.stretch import ANGLE_MEMORY
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.local_fit.local import estimate_locally
from curlshot.physics.local_fit.noise import noises
from curlshot.physics.local_fit.solution import LocalFit
from curlshot.physics.local_fit.spins import spin_on, spins_at
from curlshot.physics.local_fit.traces import Trace
from curlshot.synthetic.physics import Motion
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, lasting, watch

HIT = 1.0
"""Time of the hit in `hit_motion`, s."""


def fitted(seen: pd.DataFrame) -> tuple[LocalFit, Mapping[str, Trace]]:
    local = estimate_locally(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert local.fit is not None
    return local.fit, local.known


def beside(fit: LocalFit, known: Mapping[str, Trace]) -> dict[str, tuple[Estimate, Estimate]]:
    each = spins_at(fit, 0, known, noises(fit, known), np.ones(2))
    return dict(zip(fit.meetings[0].stones, each, strict=True))


def truth(motion: Motion) -> dict[str, tuple[float, float]]:
    """Spins before and after the hit."""
    (hit,) = motion.hits
    names = ("A", "B")
    ranks = (hit.first, hit.second)
    return {names[rank]: (hit.before[i][2], hit.after[i][2]) for i, rank in enumerate(ranks)}


@pytest.mark.parametrize("slow", [0.0, 0.05])
def test_spins_beside_a_hit_are_as_sure_as_they_say(slow: float) -> None:
    motion = hit_motion(1.5, 0.1, before=HIT, after=1.5, stone_friction=0.1)
    true = truth(motion)
    pulls = []
    for seed in range(15):
        rng = np.random.default_rng([83, seed])
        seen = watch(motion, rng, sd=0.002, sd_theta=0.015)
        for _, group in seen.groupby("stone"):
            errors = lasting(rng, group["t"].to_numpy(), slow, ANGLE_MEMORY)
            seen.loc[group.index, "theta"] += errors
        # What lasts is among what is stated.
        found = beside(*fitted(seen.assign(sd_theta=np.hypot(0.015, slow))))
        for stone, side in (("A", 0), ("A", 1), ("B", 1)):
            spin = found[stone][side]
            assert spin.value is not None and spin.stderr is not None
            pulls.append((spin.value - true[stone][side]) / spin.stderr)
    assert np.mean(np.abs(pulls) < 2) > 0.9
    assert 0.25 < np.mean(np.square(pulls)) < 1.5  # what is open of the loss of spin widens them


def test_spins_are_those_of_the_tracks_filter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("curlshot.physics.kalman.share_spins", lambda *_: None)
    seen = watch(hit_motion(), np.random.default_rng(5)).assign(sd_theta=0.05)
    seen["rise_a"], seen["rise_b"] = 0.1 * np.sin(seen["theta"]), 0.1 * np.cos(seen["theta"])
    fit, known = fitted(seen)
    tracks = smooth(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    noise = noises(fit, known)
    for side, frame in ((0, 10), (1, 50)):
        row = tracks[(tracks["stone"] == "A") & (tracks["frame"] == frame)].iloc[0]
        spin = spin_on(fit, fit.sides[0, "A"][side], known, noise, float(row["t"]))
        assert spin.value == pytest.approx(row["omega"], abs=0.1 * row["sd_omega"])
        assert spin.stderr == pytest.approx(row["sd_omega"], rel=0.1)


def test_a_time_between_two_detections_or_at_one_is_the_same() -> None:
    fit, known = fitted(watch(hit_motion(), np.random.default_rng(6)))
    rank, noise = fit.sides[0, "A"][0], noises(fit, known)
    moment = float(known["A"].t[12])
    at, near = (spin_on(fit, rank, known, noise, moment + dt) for dt in (0.0, 1e-6))
    assert at.value == pytest.approx(near.value, rel=1e-4)
    assert at.stderr == pytest.approx(near.stderr, rel=1e-3)


def test_a_stone_at_rest_does_not_spin_and_angles_never_seen_tell_nothing() -> None:
    seen = watch(hit_motion(), np.random.default_rng(7))
    assert beside(*fitted(seen))["B"][0] == Estimate(0.0, 0.0)
    blind = seen.assign(theta=np.nan, sd_theta=np.nan)
    assert beside(*fitted(blind))["A"] == (Estimate(), Estimate())


def test_a_spin_that_is_not_seen_follows_from_the_other_stones() -> None:
    motion = hit_motion(1.5, 0.1, before=HIT, stone_friction=0.1)
    seen = watch(motion, np.random.default_rng(8), sd_theta=0.005)
    hidden = (seen["stone"] == "B") & (seen["t"] > HIT - 0.1)
    seen.loc[hidden, ["theta", "sd_theta"]] = np.nan
    found = beside(*fitted(seen))
    spin, (before, after) = found["B"][1], found["A"]
    assert None not in (spin.value, spin.stderr, before.value, after.value)
    # Equal stones: the rub turns both by as much.
    assert spin.value == pytest.approx((after.value or 0.0) - (before.value or 0.0))
    assert spin.value == pytest.approx(truth(motion)["B"][1], abs=2 * (spin.stderr or 0.0))
