from __future__ import annotations

import numpy as np
import pytest

import curlshot.physics.simulator.batch
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, IceLaw
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.many import Outcomes, simulate_many
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, States, StoneStart

COUNT = 24
STONES = (
    StoneStart("A", 0.0, -3.0, 0.05, 2.0, 1.0),
    StoneStart("B", 0.1, 0.0),
    StoneStart("C", 0.15, 0.6),
)


def thrown(shot: Shot) -> States:
    """Variants of a shot: the first stone thrown from places beside each other."""
    states = States.of(shot, COUNT)
    states.x[:, 0] += np.linspace(-0.5, 0.5, COUNT)
    return states


def assert_alike(one: Outcomes, two: Outcomes) -> None:
    np.testing.assert_allclose([one.x, one.y], [two.x, two.y], atol=1e-6, rtol=0)
    assert (one.hits == two.hits).all()
    assert (one.in_play == two.in_play).all()


@pytest.mark.parametrize("bounds", [None, Bounds(1)])
def test_together_and_alone_variants_end_alike(
    bounds: Bounds | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    shot = Shot(STONES, ice=FCV1(), curl=FCV1Curl(), bounds=bounds)
    monkeypatch.setattr(curlshot.physics.simulator.batch, "FEW", 0)
    together = simulate_many(shot, thrown(shot))
    monkeypatch.setattr(curlshot.physics.simulator.batch, "FEW", COUNT)
    assert_alike(together, simulate_many(shot, thrown(shot)))
    assert together.hits.any() and not together.hits.all()


def test_a_variant_does_not_feel_the_others() -> None:
    """Among slow and fast ones, each with laws of its own, one ends as without them."""
    shot = Shot(STONES, ice=Constant(0.01), curl=NoCurl())
    states = thrown(shot)
    states.vy[:, 0] = np.linspace(0.3, 4.0, COUNT)
    ice: list[IceLaw] = [Constant(0.008), FCV1()] * (COUNT // 2)
    whole = simulate_many(shot, states, ice=ice)
    half = slice(0, COUNT // 2)
    part = States(**{key: value[half] for key, value in vars(states).items()})
    some = simulate_many(shot, part, ice=ice[half])
    assert_alike(Outcomes(*(value[half] for value in vars(whole).values())), some)


def test_no_stone_is_faster_than_all_its_energy_would_make_it() -> None:
    """Light stones behind a heavy one: the table of curves reaches their speeds."""
    stones = (
        StoneStart("A", 0.0, -2.0, 0.0, 3.0, mass=20.0),
        StoneStart("B", 0.0, 0.0, mass=2.0),
        StoneStart("C", 0.0, 0.6, mass=0.2),
    )
    shot = Shot(stones, ice=FCV1(), curl=NoCurl())
    done = simulate(shot)
    fastest = max(hit.after["C"].vy for hit in done.hits if "C" in hit.stones)
    assert fastest > 8
    out = simulate_many(shot, States.of(shot, COUNT))
    assert out.y[:, 2] == pytest.approx(done.rest["C"].y, abs=1e-6)
