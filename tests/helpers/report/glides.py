"""Tracks of stones that glide until they stop, in closed form."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.data.tracks import TRACK_COLUMNS

MU_G = 0.0109 * 9.81


def glide(
    name: str,
    place: tuple[float, float],
    speed: float = 0.0,
    *,
    end: float = 20.0,
    turn: float = 0.0,
    team: str = "",
    sd: float = 0.003,
) -> pd.DataFrame:
    """A stone that comes down y, turning its path to the left at a rate, until it stops."""
    t = np.arange(0, end, 0.04)
    v = np.maximum(speed - MU_G * t, 0.0)
    heading = -np.pi / 2 + np.where(v > 0, turn * t, turn * speed / MU_G)
    velocity = v[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    steps = (velocity[1:] + velocity[:-1]) / 2 * 0.04
    xy = place + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    table = pd.DataFrame({"stone": name, "frame": np.arange(len(t)), "t": t})
    table[["x", "y"]], table[["vx", "vy"]] = xy, velocity
    table["omega"] = np.where(v > 0, 1.5, 0.0)
    table["theta"] = np.cumsum(table["omega"]) * 0.04
    for column in ("x", "y", "theta", "vx", "vy", "omega"):
        table[f"sd_{column}"] = sd
    return table.assign(seen=1, team=team)[list(TRACK_COLUMNS)]
