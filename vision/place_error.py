"""How well a camera knows where on the ice a pixel lies.

What a clip's frames share (place of the camera, lens, painted radii) is known with a covariance.
Its effect on a mapped point is far smaller than its parts, since every frame's view is fitted to
the same rings: so the shared part is moved along each principal axis of its covariance, the views
are fitted again, and what the ice point does is added up.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.adjust import solve
from vision.camera import GRID_X, GRID_Y, PlaceError
from vision.pose import Marks, View, camera, project

Array = NDArray[np.float64]

YARDSTICK_SD = 0.003
"""How well the outer circle is painted to its nominal radius and its edge made out, m."""

NEGLIGIBLE = 1e-3
"""Principal axes whose effect is below this share of the largest are left out."""


def place_error(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    rig_cov: Array,
    size: tuple[int, int],
) -> PlaceError:
    """Carry the covariance of what frames share over to points on the ice.

    Parameters
    ----------
    frames, views : sequence of Marks, of View
        A few frames that show what the clip shows.
    rig, rig_cov : ndarray, shapes (12,) and (12, 12)
        Shared part and its covariance, as `vision.adjust.solve` gives them.
    size : tuple of int
        Width and height of the picture, px.
    """
    points = np.stack(np.meshgrid(GRID_X, GRID_Y), axis=-1).reshape(-1, 2)
    values, axes = np.linalg.eigh(rig_cov)
    squares, weights = np.zeros(len(points)), np.full(len(points), 1e-6)
    for marks, view in zip(frames, views, strict=True):
        pixels = project(points, view.vector, rig, size)
        # What a frame does not show has no say, unless no frame shows it.
        weight = np.where(((pixels > 0) & (pixels < size)).all(-1), 1.0, 1e-6)
        weights += weight
        for value, axis in zip(values, axes.T, strict=True):
            if value <= NEGLIGIBLE**2 * values[-1]:
                continue
            moved = rig + np.sqrt(value) * axis
            fit = solve([marks], [view], moved, size, iterations=4)
            off = camera(fit.views[0], moved, size).ice(pixels) - points
            squares += weight * np.nan_to_num((off**2).sum(-1), nan=1.0, posinf=1.0) / 2
    yardstick = YARDSTICK_SD / HOUSE.twelve_foot * np.hypot(*points.T)
    sd = np.sqrt(squares / weights + yardstick**2 / 2)
    return PlaceError(np.minimum(sd, 1.0).reshape(len(GRID_Y), len(GRID_X)))
