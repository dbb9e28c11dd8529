from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from curlshot.data.tracks import check_detections
from curlshot.physics.local_fit.traces import traces
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import ObservedShot, Unknown

NAMES = ("restitution", "friction", "A.y", "A.vy")
HELD = {"stone_friction": 0.05, "A.x": 0.0}


def observed(sd_place: float = 0.0) -> ObservedShot:
    """One stone that glides up y at 1 m/s on ice of μ = 0.01, seen 3 mm aside."""
    t = np.arange(30) / 30
    y = t - 0.5 * 0.01 * 9.81 * t**2
    table = pd.DataFrame({"stone": "A", "t": t, "x": 0.003, "y": y, "sd_x": 0.002, "sd_y": 0.002})
    table = table.assign(sd_place_x=sd_place, sd_place_y=sd_place)
    unknowns = tuple(Unknown(name, 0.0) for name in (*NAMES, *HELD))
    return ObservedShot(traces(check_detections(table)), 0.0, unknowns)


def fit(*shots: ObservedShot) -> ShotFit:
    return ShotFit(
        NAMES,
        np.array([0.8, 0.01, 0.0, 1.0]),
        np.diag([0.9, 1e-4, 1e-3, 1e-2]) ** 2,
        np.array([0.8, 0.01, 0.0, 0.0]),
        np.array([1.0, 4e-3, np.inf, np.inf]),
        HELD,
        shots or (observed(),),
        deviance=60.0,
        elsewhere=0.0,
        detections=30,
        inflation=2.0,
        settled=True,
    )


def test_what_the_detections_tell_is_apart_from_what_was_known() -> None:
    found = fit()
    assert not found.identifies("restitution")
    assert found.identifies("friction")
    assert not found.identifies("stone_friction")
    assert (found["stone_friction"].value, found["stone_friction"].stderr) == (0.05, 0.0)
    assert found["friction"].stderr == pytest.approx(1e-4)


def test_the_covariance_is_of_what_is_told() -> None:
    joint = fit().joint(("restitution", "friction", "stone_friction"))
    assert joint is not None
    assert joint.names == ("friction",)
    assert joint.cov == ((pytest.approx(1e-8),),)
    assert fit().joint(("restitution",)) is None


def test_residuals_are_of_the_fitted_shot() -> None:
    off = fit().residuals()
    assert len(off) == 30
    assert off["dx"].to_numpy() == pytest.approx(np.full(30, 0.003), abs=1e-9)
    assert off["dy"].to_numpy() == pytest.approx(np.zeros(30), abs=1e-6)
    assert fit().hits_as_seen


def test_what_places_share_is_no_misfit() -> None:
    assert fit().misfit == pytest.approx(2.0)
    assert fit(observed(0.004)).misfit == pytest.approx(2.0 / (1 + 4))


def test_stones_far_from_their_simulated_paths_are_astray() -> None:
    """However much noise that is taken for, but not where places share it, nor for a few."""
    assert not fit().diverged
    aside = replace(fit(), fixed={**HELD, "A.x": 0.033})
    assert aside.misfit == fit().misfit
    assert aside.diverged
    assert not replace(fit(observed(0.004)), fixed=aside.fixed).diverged
    trace = observed().traces["A"]
    few = np.where(np.arange(30)[:, None] < 14, trace.xy + 1.0, trace.xy)
    assert not fit(replace(observed(), traces={"A": replace(trace, xy=few)})).diverged


def test_of_several_shots_each_has_its_own_unknowns() -> None:
    names = ("restitution", "friction", "0:A.y", "1:A.y", "0:A.vy", "1:A.vy")
    several = replace(
        fit(observed(), observed()), names=names, values=np.array([0.8, 0.01, 0.0, 0.5, 1.0, 2.0])
    )
    assert [several.state(rank)["A.y"] for rank in range(2)] == [0.0, 0.5]
    assert [several.state(rank)["A.vy"] for rank in range(2)] == [1.0, 2.0]
    assert several.state(1)["restitution"] == 0.8
    assert several.state(1)["stone_friction"] == 0.05
