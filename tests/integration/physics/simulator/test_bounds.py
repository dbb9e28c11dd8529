from __future__ import annotations

import numpy as np
import pytest

from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import FCV1
from curlshot.physics.impact import Frictional
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.many import simulate_many
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, States, StoneStart

R = 0.145


@pytest.mark.parametrize("play", [1, -1])
def test_each_variant_leaves_as_it_does_alone(play: int) -> None:
    stones = (
        StoneStart("A", 0.1, -7.5 * play, 0.05, 2.6 * play, 1.0),
        *(
            StoneStart(name, 0.5 * (k % 4 - 1.5) + 0.1, (0.5 * (k // 4) - 0.2) * play)
            for k, name in enumerate("BCDEFGHI")
        ),
        StoneStart("G1", 0.6, -7.2 * play),
    )
    shot = Shot(stones, Frictional(0.83, 0.2), FCV1(), FCV1Curl(), R, Bounds(play))
    count = 60
    rng = np.random.default_rng(1)
    states = States.of(shot, count)
    states.x[:, 0] += rng.normal(0, 0.3, count)
    states.vy[:, 0] *= rng.uniform(0.3, 1.4, count)
    out = simulate_many(shot, states)
    gone = 0
    for k in range(count):
        columns = {key: value[k] for key, value in vars(states).items()}
        own = tuple(
            StoneStart(
                stone.name, *(float(columns[key][i]) for key in ("x", "y", "vx", "vy", "omega"))
            )
            for i, stone in enumerate(stones)
        )
        alone = simulate(Shot(own, shot.impact, shot.ice, shot.curl, R, shot.bounds))
        rests = list(alone.rest.values())
        assert out.in_play[k].tolist() == [rest.in_play for rest in rests]
        places = np.array([(rest.x, rest.y) for rest in rests])
        np.testing.assert_allclose(np.stack([out.x[k], out.y[k]], -1), places, atol=1e-6)
        gone += len(alone.gone)
    assert gone > 20
