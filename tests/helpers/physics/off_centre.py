"""What tests of off centre share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.traces import Trace
from curlshot.tests.helpers.physics.watch import lasting

Floats = NDArray[np.float64]
SD, PLACE, FPS = 0.0004, 0.002, 30
T = np.arange(0, 5, 1 / FPS)
AHEAD, LEFT = 0.0045, -0.001


def glide(t: Floats, speed: float = 1.0, slowing: float = 0.09) -> Floats:
    """Places of a stone that goes up y and is slowed evenly until it stops."""
    t = np.minimum(t, speed / slowing)
    return np.column_stack([0.3 + 0.02 * t, speed * t - 0.5 * slowing * t**2])


def wobble(theta: Floats) -> Floats:
    """Where the cap is on the ice, seen from the centre."""
    cos, sin = np.cos(theta), np.sin(theta)
    return np.column_stack([cos * AHEAD - sin * LEFT, sin * AHEAD + cos * LEFT])


def seen(xy: Floats, omega: float = 1.6, seed: int = 0, place: float = PLACE) -> Trace:
    """Detections of a stone's centre that err by little each and by more for a while."""
    rng = np.random.default_rng(seed)
    t = np.arange(len(xy)) / FPS
    slow = np.column_stack([lasting(rng, t, 0.5 * SD, 0.3) for _ in range(2)])
    return Trace(
        "A", t, xy + slow + rng.normal(0, SD, xy.shape), np.full_like(xy, 1.2 * SD),
        0.4 + omega * t, np.full(len(t), 0.02), np.full_like(xy, place), np.zeros_like(xy),
    )  # fmt: skip
