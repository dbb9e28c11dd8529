from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.physics.estimate import POOR_FIT, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.shot_fit.global_fit import fit_shots
from curlshot.physics.shot_fit.model_selection import STRAIGHT
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch


@cache
def whole(speed: float = 1.5, seed: int = 1, sd: float = 0.005) -> ShotFit:
    motion = hit_motion(speed, 0.08, others=(Start(0.0, 0.8),))
    seen = watch(motion, np.random.default_rng(seed), sd=sd)
    fit = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS).shot_fit
    assert fit is not None
    return fit


def test_the_laws_and_their_errors() -> None:
    pulls = []
    for seed in range(4):
        fit = whole(seed=seed)
        for name, true in (("restitution", 0.83), ("stone_friction", 0.05), ("friction", 0.0109)):
            found = fit[name]
            assert found.value is not None
            assert found.stderr is not None
            pulls.append((found.value - true) / found.stderr)
    assert np.sqrt(np.mean(np.square(pulls))) == pytest.approx(1.0, abs=0.5)
    assert len(fit.residuals()) == fit.detections


def test_held_unknowns_stay_and_shared_ones_are_one() -> None:
    shots = [whole(seed=seed).shots[0] for seed in (1, 2)]
    fixed = {"friction": 0.0109, **STRAIGHT}
    fit = fit_shots(shots, fixed=fixed, shared=("restitution", "stone_friction"))
    assert fit.settled
    assert fit["friction"].value == 0.0109
    assert "restitution" in fit.names
    assert "1:A.vx" in fit.names
    alone = fit_shots(shots[:1], fixed=fixed)
    assert float(fit["restitution"].stderr or 1) < float(alone["restitution"].stderr or 0)
    with pytest.raises(InputError, match="no unknown nonsense"):
        fit_shots(shots, fixed={"nonsense": 1.0})


def test_a_spin_of_which_nothing_tells_is_none() -> None:
    motion = simulate([Start(0, -3, 0, 1.5, 0.3, 1.0)], 4, ice=Ice(b=0.0109), keep_every=4)
    seen = watch(motion, np.random.default_rng(3), sd=0.003).assign(theta=np.nan)
    whole = estimate(seen, (), radius=RADIUS).shot_fit
    assert whole is not None
    found = fit_shots(whole.shots, fixed=STRAIGHT, start={"A.omega": 1.5})["A.omega"]
    assert (found.value, found.stderr) == (0.0, pytest.approx(3.0))


def test_a_fit_that_comes_to_where_another_ended_is_that_one() -> None:
    shots = [whole().shots[0]]
    fixed = {"friction": 0.0109, "loss": 0.0125, "inertia": 0.5, **STRAIGHT}
    first = fit_shots(shots, fixed=fixed)
    aside = {"restitution": 0.7, "stone_friction": 0.1}
    assert fit_shots(shots, fixed=fixed, start=aside, ends=[first]) is first
    elsewhere = first.values + 0.2 * np.sqrt(np.diag(first.cov))
    for other in (replace(first, values=elsewhere), replace(first, settled=False)):
        again = fit_shots(shots, fixed=fixed, start=aside, ends=[other])
        assert again is not other
        assert np.abs((again.values - first.values) / np.sqrt(np.diag(first.cov))).max() < 0.1


def test_friction_that_depends_on_the_speed_is_found() -> None:
    motion = simulate(
        [Start(0.06, -1.2, 0, 1.3, 0.3, 1.0), Start(0, 0)], 5,
        ice=Ice(a=0.00201, b=0.00626, v_c=0.0639), impact=Impact(0.83), step=5e-4, keep_every=4,
    )  # fmt: skip
    seen = watch(motion, np.random.default_rng(3), sd=0.003)
    found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert found.friction.law == "fit"
    assert found.friction.value == pytest.approx(0.00815, rel=0.03)
    assert found.restitution.value == pytest.approx(0.83, abs=0.01)


def test_stones_that_slide_are_not_taken_to_stick() -> None:
    rng = np.random.default_rng(401)
    starts = [Start(0.148, -1.2, 0, 1.046, 0.3, 1.0), Start(0, 0)]
    fcv1 = Ice(a=0.00201, b=0.00626, v_c=0.0639)
    for between in (0.05, 0.3):
        impact = Impact(0.83, stone_friction=between)
        motion = simulate(starts, 4, ice=fcv1, impact=impact, step=5e-4, keep_every=4)
        seen = watch(motion, rng, sd=0.003)
        found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
        assert found.shot_fit is not None
        assert found.shot_fit.inflation < 1.5
        assert found.restitution.value == pytest.approx(0.83, abs=0.01)
        # 0.3 is more than it takes to stick: how much more, no track can tell.
        assert found.shot_fit.identifies("stone_friction") == (between == 0.05)


def test_what_a_map_shares_is_no_wrong_simulation() -> None:
    """A map off by millimetres in a smooth way: detections agree far more than they are true."""
    motion = hit_motion(1.5, 0.08)
    seen = watch(motion, np.random.default_rng(5), sd=0.0005)
    field, wave = 0.004, 2.0  # m, 1/m: errors of a map are taken to be alike over a metre
    seen["x"] += field * np.sin(wave * seen["y"])
    seen["y"] += field * np.cos(wave * (seen["x"] + 0.7 * seen["y"]))
    told = estimate(
        seen.assign(sd_place_x=field, sd_place_y=field), detect_hits(seen, RADIUS), radius=RADIUS
    )
    untold = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
    assert told.shot_fit is not None
    assert told.shot_fit.inflation > POOR_FIT > told.shot_fit.misfit
    # So the one uses the whole shot, the other what is beside the hit, and says so.
    assert told.restitution.value == told.shot_fit["restitution"].value
    assert untold.shot_fit is None
    assert any("simulated paths and tracks differ" in warning for warning in untold.warnings)
    assert told.restitution.stderr is not None
    assert abs((told.restitution.value or 0) - 0.83) < 2 * told.restitution.stderr


def test_how_ice_takes_spin_need_not_be_known() -> None:
    """B spins slowly after the hit, and curls as long as it does: by FCV1 it dies on the way."""
    starts = [Start(0.1, -1.2, 0, 1.5, 0.3, 0.8), Start(0, 0)]
    ice = Ice(b=0.0109, curl=0.0082, spin_decay=0.012)
    impact = Impact(0.83, stone_friction=0.01)
    motion = simulate(starts, 8, ice=ice, impact=impact, step=5e-4, keep_every=4)
    for seed in range(2):
        seen = watch(motion, np.random.default_rng(seed), sd=0.001)
        found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
        assert found.shot_fit is not None
        told = found.shot_fit["restitution"]
        assert told.stderr is not None
        assert told.stderr < 0.001
        assert abs((told.value or 0.0) - 0.83) < 2.5 * told.stderr


def test_how_round_stones_are_need_not_be_known() -> None:
    """It tells which part of a glancing hit goes into spins; those that are seen tell it."""
    starts = [Start(0.12, -1.8, 0, 1.9, 0.3, 1.2), Start(0, 0)]
    ice = Ice(b=0.0109, curl=0.0082, spin_decay=0.02)
    for k in (0.5, 0.44):
        impact = Impact(0.83, stone_friction=0.08, inertia=k)
        motion = simulate(starts, 7, ice=ice, impact=impact, step=5e-4, keep_every=4)
        seen = watch(motion, np.random.default_rng(0), sd=0.0007)
        found = estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)
        assert found.shot_fit is not None
        for name, true in (("restitution", 0.83), ("inertia", k)):
            told = found.shot_fit[name]
            assert told.stderr is not None
            assert told.stderr < 0.01
            assert abs((told.value or 0.0) - true) < 2.5 * told.stderr
