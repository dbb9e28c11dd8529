"""Cameras that may lean to any side: fits begun on each, for none gets from one to another.

A circle seen aslant is nearly an ellipse, and looks so from either side; what tells them apart,
that the near half is larger, a lens and a camera farther away make up for in part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.vision.optics.adjust import Solution, solve
from curlshot.vision.optics.paint import Marks
from curlshot.vision.optics.pose import DOWN, View, rotation_matrix, rotation_vector
from curlshot.vision.optics.resection import VIEW_SD
from curlshot.vision.optics.rig import ANYWHERE, POSITION, Prior, start_rig

Array = NDArray[np.float64]

ASLANT = np.radians(18)
"""How far to each side, and at the usual height, such a camera is also looked for: from above a
fit finds one that stands 10 to 15° aslant only where the tee is near the picture's middle."""

STEPS = 40
"""Steps from each at most: the way is long."""


def fit_leaning(
    frames: Sequence[Marks],
    views: Sequence[View],
    rig: Array,
    size: tuple[int, int],
    *,
    prior: Prior = ANYWHERE,
    view_sd: ArrayLike = VIEW_SD,
    iterations: int = STEPS,
) -> Solution:
    """Fit cameras of which nothing else is known beforehand; as `vision.optics.adjust.solve`.

    Returns
    -------
    Solution
        The best of those begun where the camera was thought to be and leaning to each side.
    """
    fits = [
        solve(
            frames, begin, shared, size,
            prior=prior, view_sd=view_sd, iterations=iterations,
        )
        for begin, shared in ((views, rig), *_aside(views, rig, prior))
    ]  # fmt: skip
    return min(fits, key=lambda fit: fit.cost)


def _aside(views: Sequence[View], rig: Array, prior: Prior) -> Iterator[tuple[list[View], Array]]:
    """Lead a camera about the tee to each side, nearer or farther with its zoom: views and rigs."""
    zoom = prior.mean[POSITION][2] / rig[POSITION][2]
    for way in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
        turn = rotation_matrix(ASLANT * np.array([*way, 0.0])).T @ DOWN
        led = [
            View(
                np.append(
                    rotation_vector(view.rotation @ turn.T @ DOWN.T), view.vector[3] + np.log(zoom)
                )
            )
            for view in views
        ]
        yield led, start_rig(prior, zoom * turn @ rig[POSITION])
