"""Cameras of a Tracker project: its coordinate system, in each frame of a clip."""

from __future__ import annotations

import numpy as np

from curlshot.data.errors import InputError
from curlshot.data.progress import Progress, no_progress
from curlshot.data.trk import Project
from curlshot.data.units import LENGTH_UNITS, unit_of_lengths
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.optics.tracker_view import CORNER
from curlshot.vision.video.reader import Video


def project_cameras(
    video: Video,
    project: Project,
    length_unit: str | None = None,
    progress: Progress = no_progress,
    placed: Placed = nobody,
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Give the frames of a clip Tracker's coordinate system for a camera, and what to know of it.

    Parameters
    ----------
    video : Video
        Frames with their times.
    project : Project
        Whose calibration it is.
    length_unit : str, optional
        Unit of its lengths where the project does not say.
    progress : Progress
    placed : Placed
        Told of each frame and its camera.

    Raises
    ------
    InputError
        A project without a calibration, or with one of other pixels than those of the clip, or in
        an unknown length unit.
    """
    project.refuse_uncalibrated()
    source = project.source
    if project.filters:
        raise InputError(
            f"{source}: its calibration belongs to a video changed by filters"
            f" ({', '.join(project.filters)}); they are not applied here, so it does not fit"
        )
    metres = LENGTH_UNITS[unit_of_lengths(project.length_unit, length_unit, source, "project")]
    cameras = []
    for done, frame in enumerate(video, 1):
        axes = project.axes.at([frame.index])
        (ox, oy), (sx, sy) = axes.origin[0] - CORNER, axes.scale[0] / metres
        cos, sin = float(np.cos(axes.angle[0])), float(np.sin(axes.angle[0]))
        if sx * sy < 0:
            raise InputError(f"{source}: one of its axes is mirrored; calibrate it again")
        similarity = np.array([[sx * cos, -sx * sin, ox], [-sy * sin, -sy * cos, oy], [0, 0, 1.0]])
        cameras.append(Camera(frame.index, frame.t, similarity, video.size))
        placed(frame, cameras[-1])
        progress("camera", done, video.expected)
    return tuple(cameras), (
        f"{source}: its calibration is a plain scale: perspective, the height of the caps and its"
        " own error are not corrected for",
    )
