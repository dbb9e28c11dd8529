"""What tests of rate filter share."""

from __future__ import annotations

import numpy as np

from curlshot.physics.filter.stretch import Model, Stretch


def random_stretch(rng: np.random.Generator, n: int) -> Stretch:
    """A path that moves and rests by turns, at uneven times, with gaps and outliers."""
    t = np.cumsum(rng.uniform(0.01, 0.2, n))
    rest = np.cumsum(rng.random(n) < 0.1) % 2 == 1
    idle = rest & (rng.random(n) < 0.8)
    z = np.cumsum(rng.normal(0, 0.05, (n, 3)), axis=0) + rng.normal(0, 3, 3)
    z[rng.random(n) < 0.1, :2] += 5.0
    z[rng.random(n) < 0.2, :2] = np.nan
    z[rng.random(n) < 0.2, 2] = np.nan
    z[rng.integers(n), :2] = 1.0
    return Stretch(
        t,
        z,
        rng.uniform(1e-4, 0.02, (n, 3)),
        rng.uniform(0, 0.02, (n, 3)),
        np.cumsum(rng.random(n) < 0.05),
        rest,
        idle,
        rng.normal(0, 1, (n, 2)) * ~rest[:, None],
        Model(float(rng.uniform(0, 0.2)), 0.05),
    )
