"""Marks of a clip as a known camera shows them."""

from __future__ import annotations

import numpy as np

from curlshot.synthetic.camera import View as TrueView
from curlshot.vision.optics.paint import (
    TEE_LINE,
    Marks,
)
from curlshot.vision.optics.rig import OVERHEAD

SIZE = (1280, 720)


def seen_marks(true: TrueView, rng: np.random.Generator, kinds: int, noise: float) -> Marks:
    """Points of the first `kinds` lines of a nominal house, measured with noise."""
    angle = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    straight = np.linspace(-1.9, 1.9, 60)
    rig = OVERHEAD.mean
    radius = np.repeat([1.829, rig[6], rig[7], 0, 0], 60)[: 60 * kinds]
    line = np.repeat(np.arange(5), 60)[: 60 * kinds]
    along = np.concatenate([angle] * 3 + [straight] * 2)[: 60 * kinds]

    def places(at: np.ndarray) -> np.ndarray:
        x = np.where(line < 3, radius * np.cos(at), np.where(line == TEE_LINE, at, 0.0))
        y = np.where(line < 3, radius * np.sin(at), np.where(line == TEE_LINE, 0.0, at))
        return true.project(np.stack([x, y, np.zeros(len(line))], axis=-1))

    pixel = places(along)
    ahead = places(along + 1e-4) - pixel
    normal = np.stack([ahead[:, 1], -ahead[:, 0]], axis=-1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    pixel = pixel + normal * rng.normal(0, noise, (len(line), 1))
    return Marks(line, along, pixel, normal, np.full(len(line), 0.45))
