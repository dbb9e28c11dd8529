from __future__ import annotations

import json
from dataclasses import replace

import pytest

from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Fit, IceLaw, Penner
from curlshot.physics.impact import Frictional, PointMass, RigidBody
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.physics.simulator.values import shot_of, shot_values

STONES = (StoneStart("A", 0, -2, 0, 2, omega_after=(0.3, 0.1)), StoneStart("B", 0, 0, mass=19.0))
SHOT = Shot(STONES, PointMass(0.8), FCV1(), FCV1Curl(), 0.14, Bounds(-1))


def test_a_shot_is_told_in_full() -> None:
    values = shot_values(SHOT)
    assert values["impact"] == {"name": "point-mass", "restitution": 0.8}
    assert values["ice"]["name"] == "fcv1" and values["ice"]["gravity"] == 9.807
    assert values["curl"]["name"] == "fcv1" and values["bounds"]["play"] == -1
    assert [stone["omega_after"] for stone in values["stones"]] == [[0.3, 0.1], []]


@pytest.mark.parametrize("ice", [FCV1(), Constant(0.01), Fit(0.002, 0.06, 0.006), Penner(0.009)])
def test_it_comes_back_as_it_was(ice: IceLaw) -> None:
    for impact in (PointMass(0.7), RigidBody(0.6), Frictional(0.8, 0.1, 0.45)):
        shot = replace(SHOT, ice=ice, curl=NoCurl(), impact=impact, bounds=None)
        for there in (shot, SHOT):
            assert shot_of(json.loads(json.dumps(shot_values(there), allow_nan=False))) == there


@pytest.mark.parametrize(
    "wrong",
    [{"ice": {"name": "sand"}}, {"ice": {"name": "fit", "d": 1.0}}, {"stones": [{"x": 1.0}]}],
)
def test_what_is_no_shot_is_refused(wrong: dict[str, object]) -> None:
    with pytest.raises((KeyError, TypeError, ValueError)):
        shot_of({**shot_values(SHOT), **wrong})
