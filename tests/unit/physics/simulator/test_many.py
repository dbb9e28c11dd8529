from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from curlshot.data.errors import InputError
from curlshot.physics.curl import NoCurl
from curlshot.physics.ice import FCV1, Constant, IceLaw
from curlshot.physics.impact import Frictional, RigidBody
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, States, StoneStart
from curlshot.tests.helpers.physics.many import (
    BOTH_MOVE,
    COUNT,
    FROZEN,
    HOUSE,
    R,
    assert_same,
    one_by_one,
    thrown,
)


def test_stones_of_another_size_in_each_variant() -> None:
    shot = Shot(HOUSE, Frictional(0.85, 0.1))
    radii = np.linspace(0.99, 1.01, COUNT) * shot.radius
    out = simulate_many(shot, States.of(shot, COUNT), radius=radii)
    assert_same(out, [simulate(replace(shot, radius=radius)) for radius in radii.tolist()])
    assert len({tuple(row) for row in out.x.tolist()}) == COUNT
    with pytest.raises(ValueError, match="shape"):
        simulate_many(shot, States.of(shot, COUNT), radius=radii[1:])


def test_every_variant_has_its_own_ice_and_restitution() -> None:
    shot = Shot(HOUSE, Frictional(0.8, 0.2), Constant(), NoCurl(), R)
    states = thrown(shot)
    rng = np.random.default_rng(1)
    ice: list[IceLaw] = [Constant(float(mu)) for mu in rng.choice([0.008, 0.01, 0.012], COUNT)]
    e = rng.uniform(0.5, 1.0, COUNT)
    out = simulate_many(shot, states, ice=ice, vary={"restitution": e})
    assert_same(out, one_by_one(shot, states, ice, e))
    # The law counts: harder ice stops sooner.
    again = simulate_many(shot, states, vary={"restitution": e})
    assert np.abs(again.y - out.y).max() > 0.1


@pytest.mark.parametrize("after", [(0.5, -0.2), 0.3, 0.0])
def test_masses_and_given_spins_count(after: float | tuple[float, ...]) -> None:
    stones = tuple(
        replace(stone, omega_after=after, mass=19.0 - k) for k, stone in enumerate(BOTH_MOVE)
    )
    shot = Shot(stones, RigidBody(0.8), Constant(), NoCurl(), R)
    states = thrown(shot)
    assert_same(simulate_many(shot, states), one_by_one(shot, states))


def test_the_rigid_body_model_asks_for_spins_after() -> None:
    blind = Shot(BOTH_MOVE, RigidBody(0.8), Constant(), NoCurl(), R)
    with pytest.raises(InputError, match="is hit but has no omega_after"):
        simulate_many(blind, thrown(blind))


def test_the_order_of_variants_does_not_matter() -> None:
    shot = Shot(HOUSE, Frictional(0.8, 0.2), radius=R)
    states = thrown(shot)
    turned = States(**{key: value[::-1] for key, value in vars(states).items()})
    one, two = simulate_many(shot, states), simulate_many(shot, turned)
    np.testing.assert_allclose(two.y[::-1], one.y, atol=1e-9)


def test_stones_at_rest_stay() -> None:
    shot = Shot((StoneStart("A", 0, 0), StoneStart("B", 1, 2)), radius=R)
    out = simulate_many(shot, States.of(shot, COUNT))
    assert (out.x == [0, 1]).all() and (out.y == [0, 2]).all() and not out.hits.any()


def test_mistakes_are_told() -> None:
    shot = Shot(HOUSE, radius=R)
    states = thrown(shot)
    with pytest.raises(ValueError, match="shape"):
        simulate_many(Shot(FROZEN), states)
    with pytest.raises(ValueError, match="laws of ice"):
        simulate_many(shot, states, ice=[FCV1()])
    with pytest.raises(ValueError, match="parameters"):
        simulate_many(shot, states, vary={"restitution": [0.8]})
    states.vx[3, 0] = np.nan
    with pytest.raises(InputError, match="not finite"):
        simulate_many(shot, states)


def test_it_says_how_many_are_done() -> None:
    shot, told = Shot(FROZEN[:1]), list[tuple[str, int, int | None]]()
    simulate_many(shot, States.of(shot, COUNT), progress=lambda *at: told.append(at))
    assert told == [("throws", n, COUNT) for n in (0, COUNT)]
