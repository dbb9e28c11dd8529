from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.data.sheet import GRAVITY
from curlshot.physics.local_fit.glides import measure_glides
from curlshot.synthetic.physics import Ice, Start, simulate
from curlshot.tests.helpers.physics.glides import glide, local, slowed


@pytest.mark.parametrize("duration", [1.0, 2.0, 4.0])
def test_an_error_that_places_share_tells_in_the_friction(duration: float) -> None:
    told = local(glide(duration, 0.002, 0.002))
    assert told.friction.value is not None and told.friction.stderr is not None
    assert abs(told.friction.value - 0.1 / GRAVITY) < 2 * told.friction.stderr
    (honest,) = told.glides
    (blind,) = local(glide(duration, 0.0, 0.0)).glides
    assert honest.stderr is not None and blind.stderr is not None
    assert 1.3 * blind.stderr < honest.stderr < 0.02


def test_the_friction_at_1_m_s_is_as_unsure_as_the_power_of_the_speed() -> None:
    """Glides at other speeds say more of both than one, however long."""
    one = slowed(0.5, 3.0)
    late = slowed(0.5, 16.0)
    late = late[late["t"] > 12.5].assign(stone="B", x=2.0)
    alone, both = local(one).friction, local(pd.concat([one, late])).friction
    assert alone.stderr is not None and both.stderr is not None
    assert both.stderr < 0.4 * alone.stderr
    for friction in (alone, both):
        assert friction.value is not None and friction.stderr is not None
        assert abs(friction.value - 0.1 / GRAVITY) < 2 * friction.stderr


def test_a_path_turns_at_its_rate_half_way() -> None:
    (glide,) = local(slowed(0.25, 10.0, turn=0.01)).glides
    assert glide.turn_rate == pytest.approx(0.01, rel=0.03)


def test_a_law_goes_with_the_friction_at_1_m_s() -> None:
    table = slowed(0.5, 16.0)
    late = local(table[table["t"] > 10.0])
    (glide,), friction = late.glides, late.friction
    assert friction.law == "fit" and glide.friction is not None and glide.speed is not None
    assert friction.a is not None and friction.v_c is not None and friction.b is not None
    assert friction.a / (1.0 + friction.v_c) + friction.b == pytest.approx(friction.value)
    # Where it was seen it is as it was seen.
    assert friction.a / (glide.speed + friction.v_c) + friction.b == pytest.approx(
        glide.friction, rel=0.03
    )


@pytest.mark.parametrize("power", [0.0, 0.5])
def test_a_friction_counts_as_constant_until_glides_tell_that_it_falls(power: float) -> None:
    """At 2 m/s a power of the speed not known would be a tenth of it."""
    table = slowed(power, 5.0)
    blurred, sharp = (
        local(table.assign(**{axis: table[axis] + rng.normal(0, sd, len(table)) for axis in "xy"},
                           sd_x=sd, sd_y=sd)).friction
        for rng, sd in ((np.random.default_rng(5), 0.01), (np.random.default_rng(5), 0.0005))
    )  # fmt: skip
    assert blurred.law == "constant" and sharp.law == ("fit" if power else "constant")
    for friction in (blurred, sharp):
        assert friction.value is not None and friction.stderr is not None
        assert abs(friction.value - 0.1 / GRAVITY) < 2 * friction.stderr
    if not power:
        assert blurred.value == pytest.approx(0.1 / GRAVITY, rel=0.03)


def test_glides_that_no_power_of_the_speed_explains_tell_none() -> None:
    """Stones that are pushed or slowed anyhow: what a power leaves is as bad as without."""
    tables = []
    for k, (speed, slowing) in enumerate([(2.0, 0.1), (1.5, 0.02), (1.0, 0.3), (0.6, 0.2)]):
        t = np.arange(0, 2, 0.04)
        y = speed * t - 0.5 * slowing * t**2
        tables.append(
            pd.DataFrame({"stone": "ABCD"[k], "frame": range(50), "t": t, "x": k, "y": y})
        )
    friction = local(pd.concat(tables).assign(sd_x=0.003, sd_y=0.003)).friction
    assert friction.law == "constant"


@pytest.mark.parametrize("share", [0.0, 0.232])
def test_glides_of_several_speeds_tell_how_much_of_the_friction_fades(share: float) -> None:
    """Also at 1 m/s, where none of them is."""
    ice = Ice(b=0.01 * (1 - share), a=0.01064 * share, v_c=0.064)
    tables = []
    for k, speed in enumerate((0.5, 0.7)):
        motion = simulate([Start(2 * k, 3, 0, -speed)], 5.0, ice=ice, step=1e-3, keep_every=4)
        t = np.arange(0, 4.8, 0.04)
        xy = motion.at(t)[:, 0, :2] + np.random.default_rng(k).normal(0, 5e-4, (len(t), 2))
        rows = {"stone": "AB"[k], "frame": range(len(t)), "t": t, "x": xy[:, 0], "y": xy[:, 1]}
        tables.append(pd.DataFrame(rows))
    friction = local(pd.concat(tables).assign(sd_x=5e-4, sd_y=5e-4)).friction
    assert friction.law == ("fit" if share else "constant")
    assert friction.value == pytest.approx(0.01, rel=0.02)


@pytest.mark.parametrize(("speed", "power"), [(3.0, 0.08), (0.4, 0.34)])
def test_what_tells_too_little_slows_as_fcv1_has_it_at_its_speed(
    speed: float, power: float
) -> None:
    t = np.arange(0, 0.6, 0.04)
    y = speed * t - 0.05 * t**2
    table = pd.DataFrame({"stone": "A", "frame": range(len(t)), "t": t, "x": 0.0, "y": y})
    fit = local(table.assign(sd_x=0.001, sd_y=0.001)).fit
    assert fit is not None
    assert fit.power(0) == pytest.approx(power, abs=0.05)


def test_ice_turns_curling_stones_alone() -> None:
    told = local(slowed(0.25, 10.0))
    assert told.fit is not None
    stone, puck = (
        measure_glides(told.fit, told.known, radius).prior.across for radius in (0.1455, 0.04)
    )
    assert 0.015 < stone < 0.04
    assert puck < 0.015
