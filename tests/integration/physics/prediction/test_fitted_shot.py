from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.impact import Frictional
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.physics.prediction.ensemble import Ensemble
from curlshot.physics.prediction.fitted_shot import fitted_ensemble
from curlshot.physics.prediction.replay import simulate_measured
from curlshot.physics.prediction.uncertainty import InitialUncertainty
from curlshot.physics.shot_fit.global_fit import fit_shots
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.synthetic.physics import Motion, Start
from curlshot.synthetic.physics import simulate as simulate_truth
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch

MOTION = hit_motion(1.6, 0.06, before=1.2, after=3.0, others=[Start(0.03, 0.9)])


def seen(seed: int, motion: Motion = MOTION) -> tuple[pd.DataFrame, Estimates]:
    table = watch(motion, np.random.default_rng(seed), sd=0.003)
    found = estimate(table, detect_hits(table, RADIUS), radius=RADIUS)
    assert found.shot_fit is not None
    return table, found


def fitted(found: Estimates, *further: StoneStart) -> Ensemble:
    """The shot at its 1.0 s, otherwise known to stand at wrong places."""
    assert found.shot_fit is not None
    stones = (*(StoneStart(name, k, k, theta=0.5) for k, name in enumerate("ABC")), *further)
    still = {stone.name: np.zeros(5) for stone in stones}
    return fitted_ensemble(found.shot_fit, Shot(stones), InitialUncertainty(still, {}), 1.0, 24)


@pytest.mark.slow
def test_two_hits_end_where_they_did_as_far_as_is_stated() -> None:
    """Half a millimetre of aim is centimetres after two hits: the end says where it was."""
    pulls, off = [], []
    for seed in range(4):
        table, found = seen(seed)
        tracks = smooth(table, detect_hits(table, RADIUS), radius=RADIUS)
        done = simulate_measured(tracks, found, radius=RADIUS)
        last = done.samples["frictional"].groupby("stone").last()
        truth = MOTION.at(np.array([last["t"].iloc[0]]))[0][:, :2]
        error = last[["x", "y"]].to_numpy() - truth
        pulls.append(error / last[["sd_x", "sd_y"]].to_numpy())
        off.append(np.hypot(*error.T).max())
        again = done.scores["frictional"].rest_error
        assert set(again) == {"A", "B", "C"}
        assert max(error or 0.0 for error in again.values()) < 0.01
    assert np.max(off) < 0.01
    assert 0.4 < np.std(pulls) < 1.5


def test_draws_hang_together_as_the_fit_has_it() -> None:
    may = fitted(seen(1)[1])
    at = MOTION.times[-1] - may.start
    ends = [simulate(shot).state("C", float(at)) for shot in may.others]
    apart = np.std([(s.x, s.y) for s in ends], axis=0)
    # One by one the errors of aim would come to more than 3 cm.
    assert 1e-4 < np.hypot(*apart) < 0.01


def test_draws_of_stones_that_stick_go_where_these_were_seen() -> None:
    """Any friction above some does the same there; without it they end far from where they were."""
    motion = hit_motion(
        1.6, 0.03, before=1.2, after=3.0, stone_friction=0.2, others=[Start(0.02, 0.9)]
    )
    found = seen(1, motion)[1]
    assert found.shot_fit is not None
    sliding = next(fit for _, fit in found.shot_fit.choices if "stone_friction" in fit.names)
    fixed = {**sliding.fixed, "inertia": 0.5}  # with another they may just about slide
    sliding = fit_shots(sliding.shots, fixed=fixed, start={"stone_friction": 0.2})
    assert not sliding.identifies("stone_friction")
    residuals = found.shot_fit.residuals().set_index("stone")[["dx", "dy"]]
    for fit in (found.shot_fit, sliding):
        may = fitted(replace(found, shot_fit=fit))
        assert len(may.others) == 24
        if fit is sliding:
            rubs = [getattr(shot.impact, "stone_friction", 0.0) for shot in may.others]
            assert np.std(rubs) > 0.05
        at = float(motion.times[-1]) - may.start
        runs = [simulate(shot) for shot in may.others]
        for name in "ABC":
            ends = [(run.state(name, at).x, run.state(name, at).y) for run in runs]
            scatter = np.hypot(*np.std(ends, axis=0))
            assert 1e-4 < scatter < np.hypot(*residuals.loc[name].std())


def test_what_the_fit_knows_nothing_of_is_kept() -> None:
    other = StoneStart("D", 1.5, 2.0, 0.0, 0.4, theta=0.3)
    found = seen(2)[1]
    may = fitted(found, other)
    since = 1.0 - may.start
    run = simulate(may.likely, until=since)
    assert run.state("D", since).y == pytest.approx(2.0, abs=0.06)
    assert run.state("A", since).theta == pytest.approx(0.5, abs=1e-6)
    impossible = replace(other, vy=1e3)
    with pytest.raises(InputError):
        fitted(found, impossible)


def test_of_hits_a_shot_without_any_is_told_nothing() -> None:
    """What is not known of e then is what was not known before."""
    motion = simulate_truth([Start(0.0, -2.0, 0.0, 1.6, 0.3, 1.0), Start(1.0, 0.0)], 3.0)
    found = seen(1, motion)[1]
    assert not found.collisions and found.shot_fit is not None
    shot = Shot((StoneStart("A", 0, 0), StoneStart("B", 1, 1)), Frictional(0.7, 0.05))
    uncertainty = InitialUncertainty({name: np.zeros(5) for name in "AB"}, {}, restitution=0.06)
    may = fitted_ensemble(found.shot_fit, shot, uncertainty, 1.0, 100)
    assert may.likely.impact == shot.impact
    assert np.std([other.impact.restitution for other in may.others]) > 0.04
