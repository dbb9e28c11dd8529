"""The clip of a Tracker project: its steps, at the times that the project gives them."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import av
import numpy as np

from curlshot.data.errors import InputError
from curlshot.data.inputs import IMAGE_SUFFIXES
from curlshot.data.progress import Progress, no_progress
from curlshot.data.project import unpack_clip
from curlshot.data.trk import Project
from curlshot.data.units import LENGTH_UNITS, unit_of_lengths
from curlshot.vision.film.clip import Clip, Frame, open_clip
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.placed import Placed, nobody
from curlshot.vision.optics.tracker_view import CORNER


@dataclass
class ProjectClip(Clip):
    """A clip of which the steps of a project are used.

    Attributes
    ----------
    project : Project
        Which frames are steps, and when the first was taken.
    whole : Clip
        The frames of the video, at the video's own times.
    pace : float
        Time of the project per time of the video; not 1 where the video is in slow motion.
    """

    project: Project = field(kw_only=True)
    whole: Clip = field(kw_only=True)
    pace: float = field(kw_only=True)

    @property
    def expected(self) -> int:
        """How many steps a pass should give."""
        timing = self.project.timing
        used = np.arange(self.first, self.first + super().expected)
        return int(timing.includes(used).sum())

    def every(self) -> Iterator[Frame]:
        """Yield the steps in order."""
        timing = self.project.timing
        begin = None
        # A step may be a picture that repeats one that is none.
        for frame in self.whole.every():
            begin = frame.t if begin is None else begin
            if frame.index >= self.first and timing.includes(np.array([frame.index]))[0]:
                t = timing.origin + self.pace * (frame.t - begin)
                yield Frame(frame.index, t, frame.picture)
        for text in self.whole.warnings:
            self._warn(_by_project(text, self.files[0], self.whole.files[0]))


def open_project_clip(
    path: Path, tab: str | None = None, frames: tuple[int, int | None] | None = None
) -> ProjectClip:
    """Open the clip in a ``.trz``, or beside a ``.trk``.

    Parameters
    ----------
    path : Path
        The project.
    tab : str, optional
        Which of its tabs; the first with a clip if not given.
    frames : (first, last), optional
        Frames of the video to use of the project's, both included; `last` None for the end.

    Returns
    -------
    ProjectClip
        What was unpacked for it lasts as long as it does.

    Raises
    ------
    InputError
        A project without a clip, or one that cannot be read.
    """
    folder = Path(tempfile.mkdtemp(prefix="curlshot-"))
    try:
        project, files = unpack_clip(path, tab, folder)
        clip = _open(path, project, files, frames)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    weakref.finalize(clip, shutil.rmtree, folder, ignore_errors=True)
    return clip


def _open(
    path: Path, project: Project, files: tuple[Path, ...], frames: tuple[int, int | None] | None
) -> ProjectClip:
    timing = project.timing
    first, last = frames or (timing.start, None)
    end = timing.start + timing.step * (timing.count - 1)
    end = end if last is None else min(end, last)
    rate = 1 / timing.duration
    pictures = files[0].suffix.lower() in IMAGE_SUFFIXES
    # From the first step on, for the times count from there.
    try:
        whole = open_clip(files, rate if pictures else None, (timing.start, max(end, timing.start)))
    except InputError as error:
        raise InputError(_by_project(str(error), path, files[0])) from None
    clip = ProjectClip(
        files=(path,),
        size=whole.size,
        fps=rate / timing.step,
        frames=whole.frames,
        first=max(first, timing.start),
        last=end,
        warnings=list(project.warnings),
        project=project,
        whole=whole,
        pace=1.0 if pictures else timing.duration * _rate(files[0], whole.fps or rate),
    )
    if clip.expected == 0:
        raise InputError(
            f"{path}: no frame to use: its steps are the frames {timing.start} to {end}"
        )
    if project.filters:
        clip.warnings.append(
            f"{path}: its filters ({', '.join(project.filters)}) are not applied to the clip"
        )
    if not 0.98 < clip.pace < 1.02:
        clip.warnings.append(
            f"{path}: a frame lasts {1000 * timing.duration:.4g} ms in the project,"
            f" {1000 * timing.duration / clip.pace:.4g} ms in its video; the project's times are"
            " used"
        )
    return clip


def _by_project(text: str, project: Path, file: Path) -> str:
    """Name a file in a message by its project: where it was unpacked tells a person nothing."""
    return text.replace(f"{file.parent}{os.sep}", f"{project}: ")


def _rate(video: Path, otherwise: float) -> float:
    """Mean rate of a video, 1/s, as its container says."""
    try:
        with av.open(str(video)) as container:
            rate = container.streams.video[0].average_rate
    except (OSError, IndexError, ValueError):  # what `av` raises is one of these
        return otherwise
    return float(rate) if rate else otherwise


def project_cameras(
    clip: Clip,
    project: Project,
    length_unit: str | None = None,
    progress: Progress = no_progress,
    placed: Placed = nobody,
) -> tuple[tuple[Camera, ...], tuple[str, ...]]:
    """Give the frames of a clip Tracker's coordinate system for a camera, and what to know of it.

    Parameters
    ----------
    clip : Clip
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
    for done, frame in enumerate(clip, 1):
        axes = project.axes.at([frame.index])
        (ox, oy), (sx, sy) = axes.origin[0] - CORNER, axes.scale[0] / metres
        cos, sin = float(np.cos(axes.angle[0])), float(np.sin(axes.angle[0]))
        if sx * sy < 0:
            raise InputError(f"{source}: one of its axes is mirrored; calibrate it again")
        similarity = np.array([[sx * cos, -sx * sin, ox], [-sy * sin, -sy * cos, oy], [0, 0, 1.0]])
        cameras.append(Camera(frame.index, frame.t, similarity, clip.size))
        placed(frame, cameras[-1])
        progress("camera", done, clip.expected)
    return tuple(cameras), (
        f"{source}: its calibration is a plain scale: perspective, the height of the caps and its"
        " own error are not corrected for",
    )
