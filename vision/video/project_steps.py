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

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.data.inputs import IMAGE_SUFFIXES
from curlshot.data.project import unpack_clip
from curlshot.data.trk import Project
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.source import Source, open_source


@dataclass
class ProjectSteps(Source):
    """The frames of a clip that are steps of a project.

    Attributes
    ----------
    project : Project
        Which frames are steps, and when the first was taken.
    whole : Source
        The frames of the clip, at the clip's own times.
    pace : float
        Time of the project per time of the clip; not 1 where the clip is in slow motion.
    """

    project: Project = field(kw_only=True)
    whole: Source = field(kw_only=True)
    pace: float = field(kw_only=True)

    @classmethod
    def open(cls, path: Path, config: VideoConfig = VideoConfig()) -> ProjectSteps:
        """Open the clip in a ``.trz``, or beside a ``.trk``.

        Parameters
        ----------
        path : Path
            The project.
        config : VideoConfig
            Which of its tabs (the first with a clip if none), and which frames of the clip.

        Returns
        -------
        ProjectSteps
            What was unpacked for it lasts as long as it does.

        Raises
        ------
        InputError
            A project without a clip, or one that cannot be read.
        """
        folder = Path(tempfile.mkdtemp(prefix="curlshot-"))
        try:
            project, files = unpack_clip(path, config.tab, folder)
            steps = _open(path, project, files, config.frames)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        weakref.finalize(steps, shutil.rmtree, folder, ignore_errors=True)
        if config.fps is not None:
            steps.warn(f"{path}: the project gives the duration of a frame; `fps` is ignored")
        return steps

    @property
    def expected(self) -> int:
        """How many steps a pass should give."""
        used = np.arange(self.first, self.first + super().expected)
        return int(self.project.timing.includes(used).sum())

    def __iter__(self) -> Iterator[Frame]:
        """Yield the steps in order."""
        timing = self.project.timing
        begin = None
        for frame in self.whole:
            begin = frame.t if begin is None else begin
            if frame.index >= self.first and timing.includes(np.array([frame.index]))[0]:
                t = timing.origin + self.pace * (frame.t - begin)
                yield Frame(frame.index, t, frame.picture)
        for text in self.whole.warnings:
            self.warn(_by_project(text, self.files[0], self.whole.files[0]))


def _open(
    path: Path, project: Project, files: tuple[Path, ...], frames: tuple[int, int | None] | None
) -> ProjectSteps:
    timing = project.timing
    first, last = frames or (timing.start, None)
    end = timing.start + timing.step * (timing.count - 1)
    end = end if last is None else min(end, last)
    rate = 1 / timing.duration
    pictures = files[0].suffix.lower() in IMAGE_SUFFIXES
    # From the first step on, for the times count from there.
    used = VideoConfig(
        fps=rate if pictures else None, frames=(timing.start, max(end, timing.start))
    )
    try:
        whole = open_source(files, used)
    except InputError as error:
        raise InputError(_by_project(str(error), path, files[0])) from None
    steps = ProjectSteps(
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
    if steps.expected == 0:
        raise InputError(
            f"{path}: no frame to use: the project selects frames {timing.start} to {end}"
        )
    if project.filters:
        steps.warn(
            f"{path}: its filters ({', '.join(project.filters)}) are not applied to the clip"
        )
    if not 0.98 < steps.pace < 1.02:
        steps.warn(
            f"{path}: a frame lasts {1000 * timing.duration:.4g} ms in the project,"
            f" {1000 * timing.duration / steps.pace:.4g} ms in its video; the project's times are"
            " used"
        )
    return steps


def _by_project(text: str, project: Path, file: Path) -> str:
    """Return a message that names a file by its project: nobody knows where it was unpacked."""
    return text.replace(f"{file.parent}{os.sep}", f"{project}: ")


def _rate(video: Path, otherwise: float) -> float:
    """Return the mean rate of a video, 1/s, as its container says."""
    try:
        with av.open(str(video)) as container:
            rate = container.streams.video[0].average_rate
    except (OSError, IndexError, ValueError):  # what `av` raises is one of these
        return otherwise
    return float(rate) if rate else otherwise
