from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from curlshot.physics.filter.rate_filter import filtered, shared_response
from curlshot.physics.filter.spin_loss import spin_loss
from curlshot.physics.filter.stretch import SPIN_LOSS, SPIN_LOSS_SD, Model, Stretch
from curlshot.physics.kalman import smooth
from curlshot.tests.helpers.physics.watch import RADIUS

Floats = NDArray[np.float64]

SLOWING, SPEED, SPIN = 0.1, 1.2, 1.4


def glide(
    loss: float, seed: int = 0, sd: float = 0.004, seconds: float = 5.0, sign: float = 1.0
) -> tuple[Stretch, Floats]:
    """A stone that slows evenly and turns, and its true spin: ω = ω₀ − (loss / a) ln(v₀ / v)."""
    t = np.arange(0, seconds, 0.04)
    v = SPEED - SLOWING * t
    spin = sign * (SPIN - loss / SLOWING * np.log(SPEED / v))
    turned_less = (SPEED - v * (np.log(SPEED / v) + 1)) / SLOWING  # the integral of the logarithm
    theta = sign * (SPIN * t - loss / SLOWING * turned_less)
    n, rng = len(t), np.random.default_rng(seed)
    z = np.column_stack([0 * t, SPEED * t - 0.5 * SLOWING * t**2, theta + rng.normal(0, sd, n)])
    calm = np.zeros(n, bool)
    seen = Stretch(
        t, z, np.tile([0.001, 0.001, sd], (n, 1)), np.zeros((n, 3)), np.zeros(n, int), calm, calm,
        np.column_stack([0 * t, v]), Model(SLOWING, 0.005),
    )  # fmt: skip
    return seen, spin


def none(stretch: Stretch) -> Floats:
    return np.zeros((len(stretch.t), 2))


@pytest.mark.parametrize("loss", [0.0, 0.0125, 0.025, 0.04])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_glides_tell_how_much_spin_is_lost(loss: float, sign: float) -> None:
    glides = [glide(loss, seed, sign=sign)[0] for seed in range(4)]
    value, sd = spin_loss([(one, none(one)) for one in glides])
    assert sd < 0.001
    assert value == pytest.approx(loss, abs=2.5 * sd)


def test_its_error_is_as_stated() -> None:
    off = []
    for seed in range(60):
        seen, _ = glide(0.02, seed, sd=0.01, seconds=3.0)
        value, sd = spin_loss([(seen, none(seen))])
        off.append((value - 0.02) / sd)
    assert np.std(off) == pytest.approx(1.0, abs=0.25)
    assert abs(np.mean(off)) < 0.35


def test_what_tells_nothing_leaves_what_is_known_beforehand() -> None:
    seen, _ = glide(0.04)
    still = replace(seen, z=seen.z * [1, 1, 0])
    slow = replace(seen, speed=seen.speed * 0.01)
    resting = replace(seen, rest=~seen.rest)
    blind = replace(seen, z=seen.z * [1, 1, np.nan])
    short = glide(0.04, seconds=0.4)[0]
    for one in (still, slow, resting, blind, short):
        assert spin_loss([(one, none(one))]) == pytest.approx((SPIN_LOSS, SPIN_LOSS_SD))
    assert spin_loss([]) == pytest.approx((SPIN_LOSS, SPIN_LOSS_SD))


def test_errors_that_angles_share_or_keep_say_less_of_it() -> None:
    seen, _ = glide(0.02)
    _, sd = spin_loss([(seen, none(seen))])
    rise = np.column_stack([0.05 * np.sin(seen.z[:, 2]), 0.05 * np.cos(seen.z[:, 2])])
    assert spin_loss([(seen, rise)])[1] > 2 * sd
    lasting = replace(seen, slow=np.full_like(seen.slow, 0.02))
    assert spin_loss([(lasting, none(seen))])[1] > 2 * sd
    wild = replace(seen, z=seen.z + np.outer(np.sin(9 * seen.t), [0, 0, 0.1]))
    assert spin_loss([(wild, none(seen))])[1] > 5 * sd


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_is_open_of_the_loss_is_an_error_of_the_spin(sign: float) -> None:
    """The filter's spins are off by it where the loss is one standard error more than thought."""
    loss, sd = 0.02, 0.01
    seen, spin = glide(loss + sd, sd=1e-3, sign=sign)
    seen = replace(seen, sd=seen.sd * [1, 1, 20])  # else they would tell
    seen = replace(seen, model=replace(seen.model, spin_loss=loss, sd_spin_loss=sd))
    expected = shared_response(seen, none(seen))[:, 1, 2]
    off = filtered(seen)[0][:, 5] - spin
    assert np.abs(off).max() > 0.003
    assert off == pytest.approx(expected, abs=0.15 * np.abs(off).max())


@pytest.mark.parametrize("loss", [0.0, 0.03])
def test_spins_are_the_sharper_for_it(loss: float) -> None:
    """Of a stone that is seen for five seconds; held at what is known beforehand it was 0.009."""
    off, stated = [], []
    for seed in range(6):
        seen, spin = glide(loss, seed, sd=0.01)
        rows = {"stone": "A", "t": seen.t, "x": seen.z[:, 0], "y": seen.z[:, 1]}
        rng = np.random.default_rng(seed)
        table = pd.DataFrame({**rows, "theta": seen.z[:, 2], "sd_theta": 0.01}).assign(
            sd_x=0.001, sd_y=0.001
        )
        table[["x", "y"]] += rng.normal(0, 0.001, (len(table), 2))
        tracks = smooth(table, (), radius=RADIUS)
        off += (tracks["omega"] - spin).tolist()
        stated += tracks["sd_omega"].tolist()
    assert np.sqrt(np.mean(np.square(off))) < 0.005
    assert np.sqrt(np.mean(np.square(stated))) < 0.01
    assert np.mean(np.abs(off) < 2 * np.array(stated)) > 0.9
