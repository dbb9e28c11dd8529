"""Detections as a camera would make them of a known motion: every stone, with white noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from curlshot.synthetic.physics import Ice, Impact, Motion, Start, simulate

RADIUS = 0.1455
NAMES = "ABCDEFGHIJKLMNOP"


def hit_motion(
    speed: float = 1.5,
    offset: float = 0.08,
    *,
    before: float = 1.0,
    after: float = 2.0,
    restitution: float = 0.83,
    friction: float = 0.0109,
    stone_friction: float = 0.05,
    others: Sequence[Start] = (),
) -> Motion:
    """Return a stone that comes up y and hits one at rest at the origin after `before` seconds."""
    slow = friction * 9.81
    reach = np.sqrt((2 * RADIUS) ** 2 - offset**2)
    way = speed * before + 0.5 * slow * before**2
    starts = [Start(offset, -reach - way, 0.0, speed + slow * before, 0.3, 1.0), Start(0, 0)]
    return simulate(
        [*starts, *others],
        before + after,
        ice=Ice(b=friction),
        impact=Impact(restitution=restitution, stone_friction=stone_friction),
        step=5e-4,
        keep_every=4,
    )


def noisy_detections(
    motion: Motion,
    rng: np.random.Generator,
    *,
    fps: float = 30.0,
    sd: float = 0.005,
    sd_theta: float = 0.02,
    given: bool = True,
) -> pd.DataFrame:
    """Return what a camera sees of a motion: every stone in every frame, with white noise."""
    t = np.arange(rng.uniform(0, 1 / fps), motion.times[-1], 1 / fps)
    states = motion.at(t)
    tables = []
    for i in range(states.shape[1]):
        x, y, theta = (states[:, i, k] for k in range(3))
        table = pd.DataFrame({"stone": NAMES[i], "frame": np.arange(len(t)), "t": t})
        table["x"], table["y"] = x + rng.normal(0, sd, len(t)), y + rng.normal(0, sd, len(t))
        table["theta"] = theta + rng.normal(0, sd_theta, len(t))
        if given:
            table[["sd_x", "sd_y"]], table["sd_theta"] = sd, sd_theta
        tables.append(table)
    return pd.concat(tables, ignore_index=True)
