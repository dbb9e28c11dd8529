from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.synthetic.physics import Ice, Start, simulate
from curlshot.tests.helpers.physics.glides import local, slowed


@pytest.mark.parametrize("power", [0.0, 0.25, 0.5])
def test_errors_of_a_glide_s_friction_are_those_stated(power: float) -> None:
    rng = np.random.default_rng(7)
    table = slowed(power, 4.0)
    off = []
    for _ in range(40):
        noisy = table.assign(**{k: table[k] + rng.normal(0, 0.003, len(table)) for k in "xy"})
        (glide,) = local(noisy).glides
        assert glide.friction is not None and glide.stderr is not None and glide.speed is not None
        off.append((glide.friction - 0.1 / GRAVITY * glide.speed**-power) / glide.stderr)
    assert 0.7 < np.sqrt(np.mean(np.square(off))) < 1.3


@pytest.mark.parametrize(("speed", "duration"), [(0.75, 5.6), (1.0, 8.0)])
def test_slow_glides_tell_no_more_of_1_m_s_than_the_form_of_the_law_allows(
    speed: float, duration: float
) -> None:
    """Two pieces, an error that both share: weights that do away with it lead outside both."""
    ice = Ice(b=0.0084, a=0.0027, v_c=0.0639)
    motion = simulate([Start(0, 3, 0, -speed)], duration + 0.1, ice=ice, step=1e-3, keep_every=4)
    t = np.arange(0, duration, 0.04)
    xy = motion.at(t)[:, 0, :2]
    for seed in range(4):
        x, y = (xy + np.random.default_rng(seed).normal(0, 0.001, xy.shape)).T
        table = pd.DataFrame({"stone": "A", "frame": np.arange(len(t)), "t": t, "x": x, "y": y})
        friction = local(table.assign(sd_x=0.001, sd_y=0.001)).friction
        assert friction.value is not None and friction.stderr is not None
        truth = ice.b + ice.a / (1 + ice.v_c)
        assert abs(friction.value - truth) < 4 * friction.stderr < 0.6 * truth
