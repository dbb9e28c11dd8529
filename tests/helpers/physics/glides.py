"""What tests of glides share."""

from __future__ import annotations

import numpy as np
import pandas as pd

from curlshot.data.tracks import check_detections
from curlshot.physics.local_fit.local import Local, estimate_locally


def glide(duration: float, sd_place: float, wobble: float) -> pd.DataFrame:
    """A stone that slows by 0.1 m/s², seen with an error that bends with the place."""
    t = np.arange(0, duration, 0.04)
    y = 1.5 * t - 0.05 * t**2
    seen = y + wobble * np.sin(2 * np.pi * y / y[-1])
    table = pd.DataFrame({"stone": "A", "frame": np.arange(len(t)), "t": t, "x": 0.0, "y": seen})
    return table.assign(sd_x=0.001, sd_y=0.001, sd_place_x=sd_place, sd_place_y=sd_place)


def local(table: pd.DataFrame) -> Local:
    return estimate_locally(check_detections(table), (), radius=0.1455)


def slowed(power: float, duration: float, turn: float = 0.0) -> pd.DataFrame:
    """A stone of 2 m/s that 0.1 m/s² slow at 1 m/s, less by a power of its speed if faster."""
    t = np.arange(0, duration, 1e-3)
    q = 1 + power
    speed = (2.0**q - 0.1 * q * t) ** (1 / q)
    ways = np.stack([-np.sin(turn * t), np.cos(turn * t)], axis=1) * speed[:, None]
    x, y = (np.cumsum(ways, axis=0) * 1e-3)[::40].T
    table = pd.DataFrame({"stone": "A", "frame": np.arange(len(x)), "t": t[::40], "x": x, "y": y})
    return table.assign(sd_x=0.003, sd_y=0.003)
