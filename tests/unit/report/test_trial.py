from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.data.results import MeasuredState
from curlshot.physics.ice import Fit
from curlshot.physics.prediction.start import measured_start
from curlshot.report.trial import sliders, trial


def test_sliders_begin_at_what_was_measured(shot):
    what_if = trial(shot.tracks, shot.results, shot.ensemble)
    start = measured_start(shot.tracks, shot.results, shot.ensemble)
    thrown = start.shot.stones[start.thrown]
    stands = {s.key: (float(s.value), float(s.step)) for s in sliders(what_if)}
    truth = {
        "restitution": shot.results.restitution.value,
        "friction": shot.results.friction.value,
        "rub": start.shot.impact.stone_friction,
        "speed": np.hypot(thrown.vx, thrown.vy),
        "spin": thrown.omega,
        "aim": 0.0,
    }
    assert stands.keys() == truth.keys()
    for key, (value, step) in stands.items():
        assert value == pytest.approx(truth[key], abs=step / 2 + 1e-12), key
    for slider in sliders(what_if):
        assert float(slider.low) <= float(slider.value) <= float(slider.high)


def test_sliders_reach_as_far_as_what_was_measured(shot):
    fast = Fit(0.001, 0.1, 0.03)
    what_if = trial(shot.tracks, shot.results, shot.ensemble)
    what_if["shot"]["ice"] = {"name": "fit", **dataclasses.asdict(fast)}
    what_if["shot"]["stones"][what_if["thrown"]]["omega"] = -9.0
    reach = {s.key: s for s in sliders(what_if)}
    assert float(reach["friction"].high) >= 0.0309
    assert float(reach["spin"].low) <= -9.0


def test_rigid_bodies_need_all_spins(shot):
    assert trial(shot.tracks, shot.results, shot.ensemble)["spins_known"]
    first, *others = shot.results.collisions
    after = {**first.after, "A": MeasuredState(0, 0, 0, 0, None)}
    blind = dataclasses.replace(
        shot.results, collisions=(dataclasses.replace(first, after=after), *others)
    )
    assert not trial(shot.tracks, blind, shot.ensemble)["spins_known"]


def test_nothing_to_throw_where_nothing_moves(shot):
    likely = shot.ensemble.likely
    still = dataclasses.replace(likely, stones=likely.stones[-1:])
    with pytest.raises(InputError, match="no stone moves"):
        trial(shot.tracks, shot.results, dataclasses.replace(shot.ensemble, likely=still))
