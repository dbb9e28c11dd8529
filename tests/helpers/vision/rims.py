"""Rims with edges at known distances."""

from __future__ import annotations

import numpy as np

from curlshot.vision.detection.rays import Rays, directions
from curlshot.vision.detection.rims import Rim, falls_along

RADIUS, RAYS = 0.14, 48
STEPS = np.linspace(0.08, 0.20, 61)


def rim_of(
    edge: np.ndarray, inside: np.ndarray, lean: np.ndarray | None = None
) -> tuple[Rays, Rim]:
    """Rays from one place on which the light goes out at these radii, shape (rays,), m."""
    light = 200 / (1 + np.exp((STEPS - edge[:, None]) / 0.002))
    lab = np.repeat(light[None, :, :, None], 3, axis=-1).astype(np.float32)
    shown = np.repeat(inside[None, :, None], len(STEPS), axis=2)
    bgr = lab.astype(np.uint8)
    rays = Rays(bgr, bgr, shown, STEPS, directions(RAYS)[0])
    use = inside[None]
    fall = falls_along(lab)[..., 0]
    return rays, Rim(fall, use, use, RADIUS, 0.02, 2.0, np.ones(1), lean=lean)
