"""Stones that glide and hit nothing: the friction of the whole of their way."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from curlshot.physics.estimate import Estimates, estimate
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.synthetic.physics import Ice, Impact, Start, simulate
from curlshot.tests.helpers.physics.watch import RADIUS, watch

EVEN = Ice(b=0.0107)
FALLING = Ice(b=0.00626286, a=0.00200985, v_c=0.06385782, curl=0.0082)


def seen_draw(ice: Ice, speed: float, rng: np.random.Generator, sd: float) -> pd.DataFrame:
    """A stone that comes to the tee and turns 1.2 rad/s; six seconds, 25 frames a second."""
    start = Start(-0.27, 4.0, 0.16 * speed, -0.99 * speed, 0.0, 1.2)
    motion = simulate([start], 6.0, ice=ice, impact=Impact(0.83), step=5e-4, keep_every=4)
    return watch(motion, rng, fps=25, sd=sd)


def measure(seen: pd.DataFrame) -> Estimates:
    return estimate(seen, detect_hits(seen, RADIUS), radius=RADIUS)


@pytest.mark.parametrize(("ice", "speed"), [(EVEN, 0.78), (FALLING, 0.92), (FALLING, 0.6)])
def test_friction_of_one_draw(ice: Ice, speed: float) -> None:
    pulls = []
    for seed in range(4):
        found = measure(seen_draw(ice, speed, np.random.default_rng(seed), 0.0005))
        assert found.shot_fit is not None
        assert found.shot_fit.settled
        assert found.friction.law == ("constant" if ice is EVEN else "fit")
        assert found.friction.value is not None
        assert found.friction.stderr is not None
        assert found.friction.stderr < 0.05 * ice.friction(1.0)
        pulls.append((found.friction.value - ice.friction(1.0)) / found.friction.stderr)
    assert np.sqrt(np.mean(np.square(pulls))) < 1.6


def test_a_cap_beside_its_stone_is_no_friction() -> None:
    """It turns with the stone, and a path that sways by millimetres is no two glides."""
    pulls = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        seen = seen_draw(EVEN, 0.78, rng, 0.0005)
        turned = seen["theta"].to_numpy() + rng.uniform(0, 6)
        seen["x"] += 0.006 * np.cos(turned)
        seen["y"] += 0.006 * np.sin(turned)
        seen[["sd_place_x", "sd_place_y"]] = 0.003
        found = measure(seen).friction
        assert found.value is not None
        assert found.stderr is not None
        assert found.stderr < 0.0003
        pulls.append((found.value - EVEN.b) / found.stderr)
    assert np.max(np.abs(pulls)) < 2


def test_a_stone_that_is_stopped_by_hand_tells_what_it_did_before() -> None:
    seen = seen_draw(EVEN, 0.78, np.random.default_rng(5), 0.0005)
    held = seen["t"] > 4.0
    last = seen[~held].iloc[-1]
    seen.loc[held, ["x", "y"]] = np.random.default_rng(6).normal(
        last[["x", "y"]].to_numpy(float), 0.0005, (int(held.sum()), 2)
    )
    found = measure(seen).friction
    assert found.value is not None
    assert found.stderr is not None
    assert abs(found.value - EVEN.b) < 3 * found.stderr
    assert found.stderr < 0.0005


def test_a_stone_that_may_have_hit_another_unseen_is_no_free_draw() -> None:
    """Against one at rest it stops, while nobody looks, sooner than on the ice."""
    impact = Impact(0.84, stone_friction=0.06)
    starts = [Start(0.01, -1.15, 0, 0.425, 0, 1.0), Start(0, 0)]
    motion = simulate(starts, 5.0, ice=Ice(b=0.0105), impact=impact, step=1e-3, keep_every=2)
    hit = motion.hits[0].t
    for seed in range(3):
        seen = watch(motion, np.random.default_rng(seed), sd=0.003)
        seen = seen[(seen["t"] - hit).abs() > 0.25].reset_index(drop=True)
        found = measure(seen).friction
        assert found.value is not None
        assert found.stderr is not None
        assert abs(found.value - 0.0105) < 2 * found.stderr
