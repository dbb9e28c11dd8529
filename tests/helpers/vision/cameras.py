"""Cameras whose marks are known, and where marks lie."""

from __future__ import annotations

import numpy as np

from curlshot.vision.optics.paint import FIXED, Marks, ice_frame, measures
from curlshot.vision.optics.pose import View, project
from curlshot.vision.optics.rig import OVERHEAD, R4, R8, start_rig

SIZE = (1280, 720)
SD = 0.3


def true_rig() -> np.ndarray:
    rig = start_rig(OVERHEAD, (-0.1, 0.15, 9.4))
    rig[3:6] = -0.03, 0.02, 0.01
    rig[R8], rig[R4] = 1.2105, 0.6235
    rig[8:] = -2.38, 2.36, 0.002, -0.001, -1.822, 6.45, 0.01
    return rig


def ice_points(
    line: np.ndarray, along: np.ndarray, rig: np.ndarray, across: np.ndarray | None = None
) -> np.ndarray:
    """Places of marks on the ice, shape (n, 2), m."""
    foot, way = ice_frame(line, along, across)
    return (foot + way * measures(rig)[line]).T


def marks(rng: np.random.Generator, view: np.ndarray, rig: np.ndarray, noise: float) -> Marks:
    """Points of all lines in the picture, measured along random normals with noise."""
    angle = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    straight = np.linspace(-2.0, 4.0, 60)
    line = np.repeat(np.arange(10), 60)
    along = np.concatenate([angle] * 3 + [straight] * 7)
    across = np.where(line == FIXED, np.tile(straight[::-1], 10), 0.0)
    place = project(ice_points(line, along, rig, across), view, rig, SIZE)
    aside = project(ice_points(line, along + 1e-4, rig, across), view, rig, SIZE) - place
    normal = np.stack([aside[:, 1], -aside[:, 0]], axis=-1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    seen = np.asarray(((place > 0) & (place < SIZE)).all(1))
    measured = place + normal * rng.normal(0, noise, (len(line), 1))
    every = Marks(line, along, measured, normal, np.full(len(line), SD), across)
    return every.pick(seen)


def views(count: int) -> list[View]:
    return [
        View(np.array([0.15 - 0.2 * s, 0.01 * s, 0.03 - 0.04 * s, 7.5 - 0.3 * s]))
        for s in np.linspace(0, 1, count)
    ]
