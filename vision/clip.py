"""Reading clips: frames in order with the time of each, from a video or from pictures."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")  # our one line, not the decoder's twenty

import cv2
import numpy as np
from numpy.typing import NDArray

from data.errors import InputError
from data.inputs import IMAGE_SUFFIXES

Image = NDArray[np.uint8]

DEFAULT_IMAGE_FPS = 25.0


@dataclass(frozen=True)
class Frame:
    """One picture (BGR, shape (h, w, 3)), its index in the clip and its time, s."""

    index: int
    t: float
    image: Image


@dataclass
class Clip:
    """A clip that can be read through, again and again, always in order.

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
    read : int
        How many frames the latest pass has given so far.
    """

    files: tuple[Path, ...]
    size: tuple[int, int]
    fps: float | None
    frames: int
    first: int = 0
    last: int | None = None
    warnings: list[str] = field(default_factory=list)
    read: int = 0

    @property
    def is_video(self) -> bool:
        """True for a video file, False for pictures."""
        return self.files[0].suffix.lower() not in IMAGE_SUFFIXES

    @property
    def expected(self) -> int:
        """How many frames a pass over the clip should give."""
        last = self.frames - 1 if self.last is None else min(self.last, self.frames - 1)
        return max(last - self.first + 1, 0)

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in order, decoding as it goes."""
        self.read = 0
        for frame in self._read_video() if self.is_video else self._read_images():
            self.read += 1
            yield frame

    def _warn(self, text: str) -> None:
        if text not in self.warnings:
            self.warnings.append(text)

    def _read_video(self) -> Iterator[Frame]:
        capture = cv2.VideoCapture(str(self.files[0]))
        try:
            index, before = 0, -np.inf
            start = end = longest = 0.0
            while self.last is None or index <= self.last:
                if not capture.grab():
                    break
                # Read after grab: the presentation time stamp of this very frame.
                t = capture.get(cv2.CAP_PROP_POS_MSEC) / 1000
                start = t if index == 0 else start
                longest, end = max(longest, t - end if index else 0.0), t
                if index >= self.first:
                    ok, image = capture.retrieve()
                    if not ok:
                        self._warn(f"{self.files[0]}: frame {index} cannot be decoded")
                    elif t <= before:
                        self._warn(
                            f"{self.files[0]}: frame {index} has no time of its own; left out"
                        )
                    else:
                        before = t
                        yield Frame(index, t, np.asarray(image, np.uint8))
                index += 1
            # Where the container does not count its frames (Matroska), the promised number is
            # duration times rate, too many if the rate varies: so the time is asked as well.
            rate = self.fps or np.inf
            missing = self.frames / rate - (end - start) > 1.5 * max(1 / rate, longest)
            ended_early = self.last is None or self.last >= index
            if ended_early and index < self.frames and missing:
                self._warn(
                    f"{self.files[0]}: ends after {index} of {self.frames} frames; used as far as"
                    " it goes"
                )
        finally:
            capture.release()

    def _read_images(self) -> Iterator[Frame]:
        rate = self.fps or DEFAULT_IMAGE_FPS
        for index, path in enumerate(self.files):
            if index < self.first or (self.last is not None and index > self.last):
                continue
            image = _read_image(path)
            if image is None:
                self._warn(f"{path}: not a readable picture; left out")
            elif (image.shape[1], image.shape[0]) != self.size:
                self._warn(f"{path}: not of the size of the first picture; left out")
            else:
                yield Frame(index, index / rate, image)


def open_clip(
    paths: Sequence[Path], fps: float | None = None, frames: tuple[int, int | None] | None = None
) -> Clip:
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
        clip = _open_images(paths, fps, first, last)
    else:
        clip = _open_video(paths, first, last)
        if fps is not None:
            clip.warnings.append(f"{paths[0]}: a video carries its own times; the rate is ignored")
    if clip.expected == 0:
        raise InputError(f"{paths[0]}: has only {clip.frames} frames; none from {first} on")
    return clip


def _open_images(paths: Sequence[Path], fps: float | None, first: int, last: int | None) -> Clip:
    image = next((i for i in map(_read_image, paths) if i is not None), None)
    if image is None:
        raise InputError(f"{paths[0]}: not a readable picture")
    size = (image.shape[1], image.shape[0])
    rate = (fps or DEFAULT_IMAGE_FPS) if len(paths) > 1 else fps
    clip = Clip(tuple(paths), size, rate, len(paths), first, last)
    if fps is None and len(paths) > 1:
        clip.warnings.append(
            f"pictures carry no times: {DEFAULT_IMAGE_FPS:g} a second assumed; say --fps"
        )
    return clip


def _open_video(paths: Sequence[Path], first: int, last: int | None) -> Clip:
    if len(paths) > 1:
        raise InputError(f"{paths[1]}: one video at a time, please")
    capture = cv2.VideoCapture(str(paths[0]))
    try:
        ok, image = capture.read() if capture.isOpened() else (False, None)
        if not ok or image is None:
            raise InputError(
                f"{paths[0]}: not a video that can be read (damaged, or not one at all)"
            )
        fps = float(capture.get(cv2.CAP_PROP_FPS))
        count = int(capture.get(cv2.CAP_PROP_FRAME_COUNT))
    finally:
        capture.release()
    size = (image.shape[1], image.shape[0])
    # Some containers do not know their length; then the clip ends where reading ends.
    return Clip((paths[0],), size, fps if fps > 0 else None, max(count, 1), first, last)


def _read_image(path: Path) -> Image | None:
    # imdecode of bytes: imread fails on non-ASCII names on some systems.
    try:
        raw = np.fromfile(path, np.uint8)
        image = cv2.imdecode(raw, cv2.IMREAD_COLOR) if raw.size else None
    except (OSError, cv2.error):
        return None
    return None if image is None else np.asarray(image, np.uint8)
