"""Decoded frames: of a video's file, or of pictures, each with the time of its container."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.data.inputs import IMAGE_SUFFIXES, picture_times
from curlshot.vision.video.deinterlace import deinterlaced
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Image, Picture, Planes

DEFAULT_IMAGE_FPS = 25.0
"""Rate of pictures where none is given, 1/s."""


@dataclass
class Source(ABC):
    """Where frames come from. Iterating gives all decoded ones of the range, in order.

    Attributes
    ----------
    files : tuple of Path
        One video, or the pictures in their order.
    size : (int, int)
        Width and height of the pictures, px.
    fps : float or None
        Nominal rate; None for a single picture. Times come from the container, not from it.
    frames : int
        How many frames the container promises; a truncated clip gives fewer.
    first, last : int
        The range of frames that is used, both included.
    warnings : list of str
        Filled while reading: what could not be read.
    """

    files: tuple[Path, ...]
    size: tuple[int, int]
    fps: float | None
    frames: int
    first: int = 0
    last: int | None = None
    warnings: list[str] = field(default_factory=list)

    @abstractmethod
    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in order, decoding on the way."""

    @property
    def expected(self) -> int:
        """How many frames a pass should give."""
        last = self.frames - 1 if self.last is None else min(self.last, self.frames - 1)
        return max(last - self.first + 1, 0)

    def close(self) -> None:  # noqa: B027 (most have nothing to close)
        """Close what was opened and not read; a pass opens it again."""

    def peek(self) -> Picture | None:
        """Return the first picture of the files before the first pass, None where that is unknown.

        It may lie before the range, and may be of another size than `size`.
        """
        return None

    def key_pictures(self) -> Iterator[Picture]:
        """Yield a few pictures of the range that are quick to decode; all where none are."""
        return (frame.picture for frame in self)

    def warn(self, text: str) -> None:
        """Keep a warning, once."""
        if text not in self.warnings:
            self.warnings.append(text)


@dataclass
class VideoFile(Source):
    """The frames of a video."""

    _begun: tuple[Any, Iterator[tuple[float, Planes]]] | None = field(
        default=None, init=False, repr=False, compare=False
    )

    @classmethod
    def open(cls, path: Path, first: int, last: int | None) -> VideoFile:
        """Open a video and decode its first frame.

        Raises
        ------
        InputError
            It cannot be read.
        """
        broken = InputError(f"{path}: not a readable video (damaged, or another kind of file)")
        try:
            container, pictures = _opened(path)
        except (av.error.FFmpegError, OSError):
            raise broken from None
        try:
            first_one = next(pictures)
            fps, count = _promised(container)
        except (StopIteration, av.error.FFmpegError, OSError):
            container.close()  # Who keeps the error would keep it open.
            raise broken from None
        height, width, _ = first_one[1].shape
        video = cls((path,), (width, height), fps, max(count, 1), first, last)
        video._begun = container, chain([first_one], pictures)
        return video

    def close(self) -> None:
        """Close the container if no pass has begun."""
        if self._begun is not None:
            self._begun[0].close()
            self._begun = None

    def peek(self) -> Picture | None:
        """Return the first picture; None once a pass has begun."""
        if self._begun is None:
            return None
        container, pictures = self._begun
        first = next(pictures)
        self._begun = container, chain([first], pictures)
        return first[1]

    def key_pictures(self) -> Iterator[Picture]:
        """Yield the key frames' pictures of a whole video; of a part of it all."""
        if self.first or self.last is not None:
            yield from super().key_pictures()
            return
        container, pictures = _opened(self.files[0])
        with container:
            container.streams.video[0].codec_context.skip_frame = "NONINTRA"
            yield from (one for _, one in pictures if one.shape[1::-1] == self.size)

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in order, decoding on the way."""
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
                    self.warn(f"{self.files[0]}: frame {index} has no time of its own; left out")
                    continue
                if picture.shape[1::-1] != self.size:
                    self.warn(f"{self.files[0]}: frame {index} has another size; left out")
                    continue
                before = t
                yield Frame(index, t, picture)
        # Where the container does not count its frames (Matroska), the promised number is
        # duration times rate, too many if the rate varies: so the time is asked as well.
        rate, count = self.fps or np.inf, index + 1
        missing = self.frames / rate - (end - start) > 1.5 * max(1 / rate, longest)
        if count < self.frames and missing:
            self.warn(
                f"{self.files[0]}: ends after {count} of {self.frames} frames; used as far as it"
                " goes"
            )


@dataclass
class ImageFiles(Source):
    """Pictures in files, one frame each."""

    @classmethod
    def open(
        cls, paths: Sequence[Path], fps: float | None, first: int, last: int | None
    ) -> ImageFiles:
        """Open pictures in the order given.

        Raises
        ------
        InputError
            None of them can be read.
        """
        image = next((i for i in map(_read_image, paths) if i is not None), None)
        if image is None:
            raise InputError(f"{paths[0]}: not a readable picture")
        size = (image.shape[1], image.shape[0])
        rate = (fps or DEFAULT_IMAGE_FPS) if len(paths) > 1 else fps
        source = cls(tuple(paths), size, rate, len(paths), first, last)
        if fps is None and len(paths) > 1:
            source.warn(
                f"pictures carry no times: {DEFAULT_IMAGE_FPS:g} a second assumed; give `fps` to"
                " change it"
            )
        times = picture_times(paths)
        longest = max((b - a for a, b in pairwise(times)), default=1.0) if times else 1.0
        if longest > 1.0:
            source.warn(
                f"{paths[0].parent}: pictures are missing, by the numbers in their names; gaps"
                f" are up to {longest:g} time steps"
            )
        return source

    def peek(self) -> Picture | None:
        """Return the first picture; None where it cannot be read."""
        return _read_image(self.files[0])

    def __iter__(self) -> Iterator[Frame]:
        """Yield the pictures in order."""
        rate = self.fps or DEFAULT_IMAGE_FPS
        times = picture_times(self.files) or range(len(self.files))
        for index, path in enumerate(self.files):
            if index < self.first or (self.last is not None and index > self.last):
                continue
            image = _read_image(path)
            if image is None:
                self.warn(f"{path}: not a readable picture; left out")
            elif image.shape[1::-1] != self.size:
                self.warn(f"{path}: differs in size from the first picture; left out")
            else:
                yield Frame(index, times[index] / rate, image)


def open_source(paths: Sequence[Path], config: VideoConfig = VideoConfig()) -> Source:
    """Open a video, or pictures in the order given.

    Raises
    ------
    InputError
        A file that is missing, empty or cannot be read as what it is, or a range without frames.
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
    first, last = config.frames or (0, None)
    if last is not None and last < first:
        raise InputError(f"frames {first}:{last}: the range is empty")
    source: Source
    if paths[0].suffix.lower() in IMAGE_SUFFIXES:
        source = ImageFiles.open(paths, config.fps, first, last)
    elif len(paths) > 1:
        raise InputError(f"{paths[1]}: one video at a time")
    else:
        source = VideoFile.open(paths[0], first, last)
        if config.fps is not None:
            source.warn(f"{paths[0]}: a video carries its own times; the rate is ignored")
    if source.expected == 0:
        source.close()
        raise InputError(f"{paths[0]}: has only {source.frames} frames; none from {first} on")
    return source


def _opened(path: Path) -> tuple[Any, Iterator[tuple[float, Planes]]]:
    """Open a video: its container, and what is decoded from it, picture by picture."""
    container = av.open(str(path))
    return container, _decoded(container)


def _promised(container: Any) -> tuple[float | None, int]:
    """Return the nominal rate, 1/s, and the number of frames as the container has them."""
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
    """Decode the frames of a video in order, each with its time, s; damaged ones are left out."""
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
