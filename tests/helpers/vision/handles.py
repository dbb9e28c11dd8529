"""Unrolled caps with a handle that turns."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.handle import cap_spectrum

RAYS = 64
RADII = np.linspace(0.012, 0.09, 8)
SURE = 0.0005
"""Standard error of a centre, m, where the whole cap is seen."""


def patch(
    turn: float, rng: np.random.Generator | None = None, shift: tuple[float, float] = (0.0, 0.0)
) -> NDArray[np.uint8]:
    """A red cap with a pale bar that is longer on one side, turned counter-clockwise."""
    angle = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)
    x, y = RADII * np.cos(angle) - shift[0], RADII * np.sin(angle) - shift[1]
    along, aside = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    bar = 1 / (1 + np.exp((np.abs(aside) - 0.012) / 0.003))
    bar = bar / (1 + np.exp((-along - 0.05) / 0.003))
    value = np.stack([80 + 90 * bar, 170 - 30 * bar, 150 - 10 * bar], -1)
    if rng is not None:
        # Errors of compressed pictures hang together over several samples and all colours.
        grain = cv2.GaussianBlur(rng.normal(0, 1, value.shape[:2]), (0, 0), 2.5)
        value = value + 6 * (grain / grain.std())[..., None]
    return np.asarray(np.clip(value, 0, 255), np.uint8)


def spectrum(turn: float, rng: np.random.Generator | None = None) -> NDArray[np.complex64]:
    return cap_spectrum(patch(turn, rng), RADII)
