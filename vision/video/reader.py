"""Reading clips: frames in order with the time of each, from a video or from pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np

from curlshot.data.errors import InputError
from curlshot.data.inputs import IMAGE_SUFFIXES, picture_times
from curlshot.vision.video.deinterlace import deinterlaced
from curlshot.vision.video.duplicates import Repeats
from curlshot.vision.video.picture import Image as Image
from curlshot.vision.video.picture import Picture, Planes, image_of
from curlshot.vision.video.telecine import Cadence, cadence_of

DEFAULT_IMAGE_FPS = 25.0
"""Rate of pictures where none is given, 1/s."""


@dataclass(frozen=True)
class Frame:
    """One picture, its index in the clip and its time, s."""

    index: int
    t: float
    picture: Picture

    @cached_property
    def image(self) -> Image:
        """The picture in colour (BGR), shape (h, w, 3)."""
        return image_of(self.picture)


@dataclass
class Video:
    """A clip that can be read through, again and again, always in order.

    Pictures that repeat the one before are left out (`curlshot.vision.video.duplicates`). Single ones
    are where they come in a cadence, which one pass shows and from the next on is followed.

    Attributes
    ----------
    files : tuple of Path
        One video, or the pictures in their order.
    size : tuple of int
        Width and height, px.
    fps : float or None
        Nominal rate; None for a single picture. Times come from the container, not from it.
    frames : int
        What the container promises; a truncated clip gives fewer.
    first, last : int
        The range of frames that is used, both included.
    warnings : list of str
        Filled while reading: what could not be read.
    read, passed : int
        How many frames the latest pass has given so far, and gone through, repeats among them.
    repeated : dict of int to (float, int)
        Of each frame that it has left out as a repeat the time, s, and the frame that it repeats;
        in the end also of those that the cadence says to be one.
    cadence : Cadence or None
        When the pictures were taken, if that is not when they are told, and a pass has shown it.
    """

    files: tuple[Path, ...]
    size: tuple[int, int]
    fps: float | None
    frames: int
    first: int = 0
    last: int | None = None
    warnings: list[str] = field(default_factory=list)
    read: int = 0
    passed: int = 0
    repeated: dict[int, tuple[float, int]] = field(default_factory=dict)
    cadence: Cadence | None = None
    _begun: tuple[Any, Iterator[tuple[float, Planes]]] | None = field(
        default=None, init=False, repr=False, compare=False
    )

    @property
    def is_video(self) -> bool:
        """True for a video file, False for pictures."""
        return self.files[0].suffix.lower() not in IMAGE_SUFFIXES

    @property
    def expected(self) -> int:
        """How many frames a pass over the clip should give."""
        last = self.frames - 1 if self.last is None else min(self.last, self.frames - 1)
        return max(last - self.first + 1, 0)

    def close(self) -> None:
        """Let go of a video of which no pass was begun; it can be read through all the same."""
        if self._begun is not None:
            self._begun[0].close()
            self._begun = None

    def peek(self) -> Picture | None:
        """Give the first picture of the files; of a video only while nothing else was read."""
        if not self.is_video:
            return _read_image(self.files[0])
        if self._begun is None:
            return None
        container, pictures = self._begun
        first = next(pictures)
        self._begun = container, chain([first], pictures)
        return first[1]

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in order, decoding as it goes."""
        repeats, known = Repeats(), self.cadence
        self.read, self.repeated, self.passed = 0, repeats.left_out, 0
        for frame in repeats.distinct(self._counted()):
            if known is not None and frame.index not in known.times:
                continue
            self.read += 1
            yield frame if known is None else replace(frame, t=known.times[frame.index])
        self.cadence = cadence_of(repeats.shown)
        if self.cadence is not None:
            self.repeated = self.repeated | self.cadence.repeats
        if self.repeated:
            self._warn(
                f"{self.files[0]}: {len(self.repeated)} of {self.passed} pictures repeat the one"
                f" before them; what is seen in them is left out{_so_taken(self.cadence)}"
            )

    def _counted(self) -> Iterator[Frame]:
        for frame in self.every():
            self.passed += 1
            yield frame

    def every(self) -> Iterator[Frame]:
        """Yield all frames, repeats among them."""
        return self._read_video() if self.is_video else self._read_images()

    def key_pictures(self) -> Iterator[Picture]:
        """Yield, of a whole video, the pictures coded by themselves, soon read; of others all."""
        if not self.is_video or self.first or self.last is not None:
            yield from (frame.picture for frame in self.every())
            return
        container, pictures = _opened(self.files[0])
        with container:
            container.streams.video[0].codec_context.skip_frame = "NONINTRA"
            yield from (one for _, one in pictures if one.shape[1::-1] == self.size)

    def _warn(self, text: str) -> None:
        if text not in self.warnings:
            self.warnings.append(text)

    def _read_video(self) -> Iterator[Frame]:
        index, before = -1, -np.inf
        start = end = longest = 0.0
        # To open a video and to decode its first picture takes as long as ten others.
        begun, self._begun = self._begun, None
        container, pictures = begun or _opened(self.files[0])
        with container:
            for index, (t, picture) in enumerate(pictures):
                if self.last is not None and index > self.last:
                    return
                start = t if index == 0 else start
                longest, end = max(longest, t - end if index else 0.0), t
                if index < self.first:
                    continue
                if t <= before:
                    self._warn(f"{self.files[0]}: frame {index} has no time of its own; left out")
                    continue
                if picture.shape[1::-1] != self.size:
                    self._warn(f"{self.files[0]}: frame {index} is of another size; left out")
                    continue
                before = t
                yield Frame(index, t, picture)
        # Where the container does not count its frames (Matroska), the promised number is
        # duration times rate, too many if the rate varies: so the time is asked as well.
        rate, count = self.fps or np.inf, index + 1
        missing = self.frames / rate - (end - start) > 1.5 * max(1 / rate, longest)
        if count < self.frames and missing:
            self._warn(
                f"{self.files[0]}: ends after {count} of {self.frames} frames; used as far as it"
                " goes"
            )

    def _read_images(self) -> Iterator[Frame]:
        rate = self.fps or DEFAULT_IMAGE_FPS
        times = picture_times(self.files) or range(len(self.files))
        for index, path in enumerate(self.files):
            if index < self.first or (self.last is not None and index > self.last):
                continue
            image = _read_image(path)
            if image is None:
                self._warn(f"{path}: not a readable picture; left out")
            elif image.shape[1::-1] != self.size:
                self._warn(f"{path}: not of the size of the first picture; left out")
            else:
                yield Frame(index, times[index] / rate, image)


def _so_taken(cadence: Cadence | None) -> str:
    """Say which cadence was followed, if one was."""
    if cadence is None:
        return ""
    rate, told = cadence.rate, cadence.told
    return (
        f"; they come as in a clip of {rate:.4g} pictures a second that is told as one of"
        f" {told:.4g}, so the others are spaced evenly in time"
    )


def open_video(
    paths: Sequence[Path], fps: float | None = None, frames: tuple[int, int | None] | None = None
) -> Video:
    """Open a video, or pictures in the order given.

    Parameters
    ----------
    paths : sequence of Path
        One video file, or one or more pictures.
    fps : float, optional
        Rate of pictures (25 if not given); not for videos, which carry their times.
    frames : (first, last), optional
        Range of frame indices to use, both included; `last` None for the end.

    Raises
    ------
    InputError
        A file that is missing, empty or cannot be read as what it is.
    """
    if not paths:
        raise InputError("no clip given")
    for path in paths:
        if not path.exists():
            raise InputError(f"{path}: no such file")
        if path.is_dir():
            raise InputError(f"{path}: a folder, not a clip; give the pictures in it")
        if path.stat().st_size == 0 and len(paths) == 1:
            raise InputError(f"{path}: the file is empty")
    first, last = frames if frames is not None else (0, None)
    if first < 0 or (last is not None and last < first):
        raise InputError(f"frames {first}:{last}: the range is empty")
    if paths[0].suffix.lower() in IMAGE_SUFFIXES:
        video = _open_images(paths, fps, first, last)
    else:
        video = _open_video(paths, first, last)
        if fps is not None:
            video.warnings.append(f"{paths[0]}: a video carries its own times; the rate is ignored")
    if video.expected == 0:
        video.close()
        raise InputError(f"{paths[0]}: has only {video.frames} frames; none from {first} on")
    return video


def _open_images(paths: Sequence[Path], fps: float | None, first: int, last: int | None) -> Video:
    image = next((i for i in map(_read_image, paths) if i is not None), None)
    if image is None:
        raise InputError(f"{paths[0]}: not a readable picture")
    size = (image.shape[1], image.shape[0])
    rate = (fps or DEFAULT_IMAGE_FPS) if len(paths) > 1 else fps
    video = Video(tuple(paths), size, rate, len(paths), first, last)
    if fps is None and len(paths) > 1:
        video.warnings.append(
            f"pictures carry no times: {DEFAULT_IMAGE_FPS:g} a second assumed; say `fps`"
        )
    times = picture_times(paths)
    longest = max((b - a for a, b in pairwise(times)), default=1.0) if times else 1.0
    if longest > 1.0:
        video.warnings.append(
            f"{paths[0].parent}: pictures are missing, by the numbers in their names; up to"
            f" {longest:g} steps of time are left between two that are there"
        )
    return video


def _open_video(paths: Sequence[Path], first: int, last: int | None) -> Video:
    if len(paths) > 1:
        raise InputError(f"{paths[1]}: one video at a time, please")
    broken = InputError(f"{paths[0]}: not a video that can be read (damaged, or not one at all)")
    try:
        container, pictures = _opened(paths[0])
    except (av.error.FFmpegError, OSError):
        raise broken from None
    try:
        first_one = next(pictures)
        fps, count = _promised(container)
    except (StopIteration, av.error.FFmpegError, OSError):
        container.close()  # Who keeps the error would keep it open.
        raise broken from None
    height, width, _ = first_one[1].shape
    video = Video((paths[0],), (width, height), fps, max(count, 1), first, last)
    video._begun = container, chain([first_one], pictures)
    return video


def _opened(path: Path) -> tuple[Any, Iterator[tuple[float, Planes]]]:
    """Open a video: its container, and what is decoded from it, picture by picture."""
    container = av.open(str(path))
    return container, _decoded(container)


def _promised(container: Any) -> tuple[float | None, int]:
    """Nominal rate, 1/s, and number of frames as the container has them."""
    stream = container.streams.video[0]
    rate = stream.average_rate or stream.guessed_rate
    fps = float(rate) if rate else None
    if stream.frames:
        return fps, int(stream.frames)
    if stream.duration:
        duration = float(stream.duration * stream.time_base)
    else:
        duration = (container.duration or 0) / av.time_base
    # Some containers do not know their length; then the clip ends where reading ends.
    return fps, round(duration * (fps or 0.0))


def _decoded(container: Any) -> Iterator[tuple[float, Planes]]:
    """Decode the pictures of a video in order, each with its time, s; damaged ones are left out."""
    if not container.streams.video:
        return
    stream = container.streams.video[0]
    # Threads that decode side by side cost a sixth more in all, and hold pictures each.
    stream.codec_context.thread_count = 1
    clock, pixel = stream.time_base, float(stream.sample_aspect_ratio or 1)
    begin = (stream.start_time or 0) * clock
    for frame in deinterlaced(_frames(container.demux(stream)), stream):
        if frame.pts is not None:
            yield float(frame.pts * (frame.time_base or clock) - begin), Planes.of(frame, pixel)


def _frames(packets: Iterator[Any]) -> Iterator[av.VideoFrame]:
    """Decode packets in order, but for those that are damaged."""
    while True:
        try:
            frames = next(packets).decode()
        except StopIteration:
            return
        except (av.error.InvalidDataError, av.error.EOFError):
            continue
        yield from frames


def _read_image(path: Path) -> Image | None:
    # imdecode of bytes: imread fails on non-ASCII names on some systems.
    try:
        raw = np.fromfile(path, np.uint8)
        image = cv2.imdecode(raw, cv2.IMREAD_COLOR) if raw.size else None
    except (OSError, cv2.error):
        return None
    return None if image is None else np.asarray(image, np.uint8)
