from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.results import (
    Estimate,
    Friction,
    Hit,
    JointEstimate,
    MeasuredState,
    NotedEstimate,
)
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.estimate import Estimates
from curlshot.physics.ice import Constant, Fit
from curlshot.physics.prediction.laws import LEAST_FRICTION, between_stones, measured_laws
from curlshot.physics.shot_fit.priors import LITERATURE

R = 0.1455


def hit(stone_friction: float | None, stderr: float | None, aside: float = 0.0) -> Hit:
    """A head-on hit of equal stones, e = 0.8, with a tangential velocity given to B."""
    before = {"A": MeasuredState(0, -0.291, 0, 1.0), "B": MeasuredState(0, 0, 0, 0)}
    after = {"A": MeasuredState(0, -0.291, -aside, 0.1), "B": MeasuredState(0, 0, aside, 0.9)}
    return Hit(
        t=1.0, stderr_t=0.001, stones=("A", "B"), normal=(0.0, 1.0), restitution=0.8, stderr=0.01,
        before=before, after=after, momentum_residual=0.0, stderr_momentum=0.01, energy_lost=0.1,
        stone_friction=stone_friction, stderr_stone_friction=stderr,
    )  # fmt: skip


def test_hits_are_weighted_and_the_whole_shot_comes_first() -> None:
    hits = (hit(0.04, 0.01), hit(0.10, 0.02), hit(None, None))
    found = between_stones(None, hits)
    assert found.value == pytest.approx((0.04 * 4 + 0.10) / 5)
    assert found.stderr == pytest.approx((1 / 0.01**2 + 1 / 0.02**2) ** -0.5)
    joint = JointEstimate(("friction", "stone_friction"), (0.01, 0.06), ((1e-8, 0.0), (0.0, 4e-6)))
    assert between_stones(joint, hits) == Estimate(0.06, pytest.approx(0.002))
    assert between_stones(None, hits[2:]) == Estimate()


def test_the_distance_at_which_stones_meet_is_a_law_of_the_shot() -> None:
    assert measured_laws(Estimates(), R).size == Estimate(1.0, 0.0)

    class Shot(Estimates):
        joint_estimate = JointEstimate(
            ("restitution", "size"), (0.8, 0.996), ((1e-4, 0.0), (0.0, 4e-6))
        )

    size = measured_laws(Shot(), R).size
    assert size.value == 0.996
    assert size.stderr == pytest.approx(0.002)


def test_loss_of_spin_and_inertia_are_as_the_shot_tells_else_as_usual() -> None:
    class Shot(Estimates):
        joint_estimate = JointEstimate(
            ("loss", "inertia"), (0.004, 0.45), ((1e-6, 0.0), (0.0, 1e-4))
        )

    untold, told = measured_laws(Estimates(), R), measured_laws(Shot(), R)
    assert untold.curl == FCV1Curl(turn=0.0, loss=0.0125)
    assert told.curl == FCV1Curl(turn=0.0, loss=0.004)
    assert measured_laws(Shot(), R / 5).curl == NoCurl()
    assert (untold.inertia, told.inertia) == (0.5, 0.45)


def test_what_a_shot_does_not_tell_is_assumed_with_its_doubt() -> None:
    laws = measured_laws(Estimates(), R)
    assert laws.restitution == LITERATURE.restitution
    assert laws.stone_friction == LITERATURE.stone_friction
    assert laws.ice == Constant(LITERATURE.friction.value)
    assert set(laws.assumed) == {"restitution", "stone_friction", "friction"}
    other = measured_laws(Estimates(), R / 5)
    assert other.restitution.stderr > 3 * laws.restitution.stderr
    assert f"{other.restitution.value} assumed" in other.assumed["restitution"]
    assert other.sd_friction > 3 * laws.sd_friction > 0
    rubbed = measured_laws(Estimates(collisions=(hit(None, None, aside=0.18),)), R)
    assert rubbed.stone_friction.value == pytest.approx(0.2)
    assert "at least about 0.2" in rubbed.assumed["stone_friction"]


def test_measured_laws_are_taken_as_they_are_if_they_can_be() -> None:
    falling = Friction(0.008, 0.0002, "fit", 0.002, 0.064, 0.0061)
    shot = Estimates(Estimate(1.02, 0.03), falling, curl=NotedEstimate(0.006, 0.001))
    laws = measured_laws(shot, R)
    assert laws.restitution == Estimate(1.0, 0.03)
    assert laws.ice == Fit(0.002, 0.064, 0.0061)
    assert laws.sd_friction == pytest.approx(0.025)
    assert (laws.curl, laws.sd_turn) == (FCV1Curl(turn=0.006, loss=0.0125), 0.001)
    assert (measured_laws(shot, 0.025).curl, measured_laws(shot, 0.025).sd_turn) == (NoCurl(), 0.0)


@pytest.mark.parametrize("mu", [0.0, -0.002])
def test_ice_that_slows_no_stone(mu: float) -> None:
    laws = measured_laws(replace(Estimates(), friction=Friction(mu, 0.003)), R)
    assert laws.ice == Constant(LEAST_FRICTION)
    assert "0 used" in laws.assumed["friction"]
    assert np.isfinite(laws.sd_friction)
