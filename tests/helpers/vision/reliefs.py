"""Unrolled caps with a handle of known height."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.patch import handle_radii
from curlshot.vision.spin.handle import cap_spectrum
from curlshot.vision.video.disk_cache import Cached

RADII = handle_radii(STONE)
RAYS = 48
ANGLE = np.arange(RAYS)[:, None] * (2 * np.pi / RAYS)


def cap(light: NDArray[np.float64], noise: float = 0.0, seed: int = 0) -> NDArray[np.complex64]:
    """Spectrum of a cap of L* 120 and this more, shape (rays, rings): the same at both heights."""
    rng = np.random.default_rng(seed)
    lab = np.full((RAYS, 2 * len(RADII), 3), (120.0, 160.0, 150.0))
    lab[..., 0] += np.tile(np.broadcast_to(light, (RAYS, len(RADII))), 2)
    return cap_spectrum(np.round(lab + rng.normal(0, noise, lab.shape)).astype(np.uint8), RADII)


def bar(height: float, turn: float = 0.0, wide: float = 0.014) -> NDArray[np.float64]:
    """A handle along one diameter, so much lighter than the cap."""
    return np.where(np.abs(RADII * np.sin(ANGLE - turn)) < wide, height, 0.0)


def seen(height: float, pixel: float = 0.01) -> Detection:
    """A stone whose handle is so much lighter than its cap."""
    return Detection(
        0.0, 0.0, 0.002, 0.002, (0.0, 0.0), np.array([120.0, 190.0, 165.0]), 1.0, 2.0,
        (1.0, 0.98), 0.0, (0.0,) * 6, (0.0, 0.0), pixel, spectrum=Cached(cap(bar(height), 1.0)),
    )  # fmt: skip
