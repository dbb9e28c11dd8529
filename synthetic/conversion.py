"""What a broadcast or an editor does to a clip after it was taken: bars, fields, repeated frames.

Each function is a renderer of the form of `curlshot.synthetic.clip.pictures` around that one.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.synthetic.camera import CameraPath
from curlshot.synthetic.clip import pictures
from curlshot.synthetic.scene import Scene

Picture = NDArray[np.uint8]

BAR = 1 / 8
"""Height of each black bar of a letterbox, as a share of the frame."""

FILM_RATE = 25.0
"""Frame rate before the conversion to the clip's own rate, 1/s."""

HELD = 6
"""Frames at the end that repeat the one before them."""


def letterboxed(
    scene: Scene,
    camera: CameraPath,
    times: ArrayLike,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Iterator[tuple[float, Picture]]:
    """Render frames with a black bar above and one below, which cover what is there."""
    bar = 2 * round(camera.size[1] * BAR / 2)
    for t, picture in pictures(scene, camera, times, shutter=shutter, supersample=supersample):
        picture[:bar] = picture[-bar:] = 0
        yield t, picture


def interlaced(
    scene: Scene,
    camera: CameraPath,
    times: ArrayLike,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Iterator[tuple[float, Picture]]:
    """Render frames of two fields, of which the one of the lower lines is taken first.

    The second field is of the middle between two frames.
    """
    first = np.asarray(times, float)
    second = first + np.median(np.diff(first)) / 2
    both = np.column_stack([first, second]).ravel()
    drawn = pictures(scene, camera, both, shutter=shutter, supersample=supersample)
    for (t, frame), (_, later) in zip(drawn, drawn, strict=True):
        frame[0::2] = later[0::2]
        yield t, frame


def pulled_down(
    scene: Scene,
    camera: CameraPath,
    times: ArrayLike,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Iterator[tuple[float, Picture]]:
    """Render 25 frames per second and repeat some, so that there is one at each of the times."""
    numbers = np.floor(np.asarray(times, float) * FILM_RATE + 1e-6).astype(int)
    yield from _repeated(scene, camera, times, numbers / FILM_RATE, shutter, supersample)


def held_at_end(
    scene: Scene,
    camera: CameraPath,
    times: ArrayLike,
    *,
    shutter: float = 0.01,
    supersample: int = 1,
) -> Iterator[tuple[float, Picture]]:
    """Render frames of which the last ones repeat the one before them."""
    moments = np.asarray(times, float)
    taken = np.minimum(moments, moments[-1 - HELD])
    yield from _repeated(scene, camera, moments, taken, shutter, supersample)


def _repeated(
    scene: Scene,
    camera: CameraPath,
    shown: ArrayLike,
    taken: NDArray[np.float64],
    shutter: float,
    supersample: int,
) -> Iterator[tuple[float, Picture]]:
    """Render the times at which frames were taken once each, and yield them as they are shown."""
    once, which = np.unique(taken, return_inverse=True)
    drawn = pictures(scene, camera, once, shutter=shutter, supersample=supersample)
    number, picture = -1, np.zeros((1, 1, 3), np.uint8)
    for t, wanted in zip(np.asarray(shown, float).tolist(), which.tolist(), strict=True):
        while number < wanted:
            number, (_, picture) = number + 1, next(drawn)
        yield t, picture
