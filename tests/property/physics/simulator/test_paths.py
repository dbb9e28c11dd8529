from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant
from curlshot.physics.simulator.motion import Motion, Path
from curlshot.physics.simulator.paths import CurveTable, Paths

LAWS = ((Constant(0.0105), NoCurl()), (FCV1(), FCV1Curl()))
TOP = 3.0


def laid(rng: np.random.Generator, count: int) -> tuple[Paths, list[Path]]:
    """Stones on either ice, all at once and one by one; some at rest, some without a spin."""
    law = rng.integers(0, len(LAWS), count)
    start, theta = rng.uniform(0, 2, count), np.zeros(count)
    place, heading = rng.uniform(-2, 2, (count, 2)), rng.uniform(-np.pi, np.pi, count)
    speed = rng.uniform(0, TOP, count) * (rng.random(count) > 0.2)
    omega = rng.uniform(-3, 3, count) * (rng.random(count) > 0.2)
    velocity = speed[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    paths = Paths(CurveTable(LAWS, TOP), law)
    paths.lay(np.arange(count), start, place, velocity, omega)
    states = np.column_stack([place, theta, velocity, omega]).tolist()
    alone = [
        Path(float(t), Motion(*state), *LAWS[k])
        for t, state, k in zip(start, states, law, strict=True)
    ]
    return paths, alone


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 1 << 30))
def test_stones_go_as_each_would_by_itself(seed: int) -> None:
    rng = np.random.default_rng(seed)
    paths, alone = laid(rng, 30)
    np.testing.assert_allclose(paths.stop, [path.stop for path in alone], atol=1e-6)
    which = rng.integers(0, 30, 100)
    t = rng.uniform(2, 40, 100)
    points, spins = paths.points(which, t), paths.omega(which, t)
    for k, time, point, spin in zip(which.tolist(), t.tolist(), points, spins, strict=True):
        expected = alone[k].point(time)
        np.testing.assert_allclose(point[:3], expected[:3], atol=1e-6)
        np.testing.assert_allclose(spin, alone[k].at(time).omega, atol=1e-5)
        if expected.speed:
            np.testing.assert_allclose(point[3], expected.heading, atol=1e-6)


def test_a_path_laid_anew_leaves_the_others_as_they_were() -> None:
    paths, _ = laid(np.random.default_rng(1), 4)
    all_four, times = np.arange(4), np.full(4, 2.5)
    before = paths.points(all_four, times)
    paths.lay(
        np.array([2]), np.array([2.5]), np.zeros((1, 2)), np.array([[0.0, 1.0]]), np.array([0.5])
    )
    after = paths.points(all_four, times)
    np.testing.assert_array_equal(after[[0, 1, 3]], before[[0, 1, 3]])
    np.testing.assert_allclose(after[2, :3], [0.0, 0.0, 1.0], atol=1e-9)
