"""Unrolled caps of which the handle rises, under a slanting view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.tests.helpers.vision.handles import RADII, RAYS
from curlshot.vision.spin.align import Complex
from curlshot.vision.spin.handle import cap_spectrum

Array = NDArray[np.float64]
TIMES = np.arange(70) / 25
TRUE = 0.4 + 1.3 * TIMES
SLANTS = np.column_stack([0.05 + 0 * TIMES, 0.38 - 0.14 * TIMES])
"""Of a stone that comes from afar to below the camera."""


def seen(turn: float, slant: Array, steep: float, rng: np.random.Generator) -> NDArray[np.uint8]:
    """A cap with a bar, longer on one side, whose height goes up by `steep` along it.

    What lies at x is seen at x + h slant; here each ray asks what is seen there.
    """
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    x, y = RADII * np.cos(angle), RADII * np.sin(angle)
    way = np.array([np.cos(turn), np.sin(turn)])
    # Where the bar is seen: from -6 to 8 cm along it, each point shifted by its height.
    along = np.linspace(-0.06, 0.08, 141)
    points = along[:, None] * (way + steep * slant)
    away = np.hypot(x[..., None] - points[:, 0], y[..., None] - points[:, 1]).min(-1)
    bar = 1 / (1 + np.exp((away - 0.011) / 0.003))
    value = np.stack([80 + 90 * bar, 170 - 30 * bar, 150 - 10 * bar], -1)
    return np.asarray(np.clip(value + rng.normal(0, 2, value.shape), 0, 255), np.uint8)


def pictures(steep: float, slants: Array = SLANTS) -> Complex:
    return turning(TRUE, slants, steep)


def turning(true: Array, slants: Array, steep: float) -> Complex:
    rng = np.random.default_rng(7)
    pairs = zip(true.tolist(), slants, strict=True)
    return np.array([cap_spectrum(seen(turn, each, steep, rng), RADII) for turn, each in pairs])


def spin_off(angles: Array) -> float:
    return float(np.polyfit(TIMES, angles - TRUE, 1)[0])
