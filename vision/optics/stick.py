"""A still camera from a calibration stick: two points of the picture, a known length apart."""

from __future__ import annotations

import numpy as np

from curlshot.data.errors import InputError
from curlshot.data.progress import Progress, no_progress
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.video.reader import Video

Stick = tuple[float, float, float, float, float]
"""Two ends (x1, y1, x2, y2), px, and the length, m."""


def stick_camera(stick: Stick, size: tuple[int, int], frame: int = 0, t: float = 0.0) -> Camera:
    """Camera that looks straight down: one scale, x to the right and y up in the picture.

    Parameters
    ----------
    stick : (x1, y1, x2, y2, metres)
        Its ends in pixels and its length. The first end is the origin.
    size : (width, height)
        Of the picture, px.

    Raises
    ------
    InputError
        Where the stick has no length.
    """
    x1, y1, x2, y2, metres = stick
    pixels = float(np.hypot(x2 - x1, y2 - y1))
    if not (np.isfinite(stick).all() and metres > 0 and pixels >= 2):
        raise InputError(
            f"stick {_written(stick)}: needs two ends at least 2 px apart"
            " and a length in metres above 0"
        )
    scale = pixels / metres
    homography = np.array([[scale, 0.0, x1], [0.0, -scale, y1], [0.0, 0.0, 1.0]])
    return Camera(frame=frame, t=t, homography=homography, size=size)


def stick_cameras(
    video: Video, stick: Stick, progress: Progress = no_progress, placed: Placed = nobody
) -> tuple[Camera, ...]:
    """Give every frame of a clip the camera of the stick; `placed` is told of each.

    Raises
    ------
    InputError
        As `stick_camera`, or where an end lies beside the picture, as it does when its pixels were
        read off a larger copy of it: its scale would then be wrong.
    """
    width, height = video.size
    if not all(0 <= x <= width and 0 <= y <= height for x, y in (stick[:2], stick[2:4])):
        raise InputError(
            f"stick {_written(stick)}: outside a frame of {width} × {height} px; read its ends in"
            " the pixels of the clip"
        )
    cameras: list[Camera] = []
    for done, frame in enumerate(video, 1):
        cameras.append(stick_camera(stick, video.size, frame.index, frame.t))
        placed(frame, cameras[-1])
        progress("camera", done, video.expected)
    return tuple(cameras)


def _written(stick: Stick) -> str:
    """Stick as it is given after ``--stick``."""
    return ",".join(f"{value:g}" for value in stick)
