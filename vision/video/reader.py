"""The reader of a clip: frames at their true times, without black bars, duplicates and fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol, Self, TypeVar

from curlshot.config import VideoConfig
from curlshot.data.errors import InputError
from curlshot.data.inputs import PROJECT_SUFFIXES, SPREADSHEET, SPREADSHEETS, TABLE_SUFFIXES
from curlshot.data.measurement import Duplicate
from curlshot.data.progress import Progress, no_progress
from curlshot.vision.video.duplicates import DuplicateFilter
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.letterbox import find_bars, hides, without_bars
from curlshot.vision.video.source import Source, open_source
from curlshot.vision.video.telecine import Telecine, find_telecine


class PerFrame(Protocol):
    """What is known of one frame, in pixels of that frame: a camera."""

    @property
    def frame(self) -> int:
        """Number of the frame."""

    def retimed(self, t: float) -> Self:
        """Return the same at another time, s."""

    def repeated(self, duplicate: int, t: float) -> Self:
        """Return the same for a frame that shows this one again, where nothing was measured."""

    def padded(self, bars: tuple[int, int], size: tuple[int, int]) -> Self:
        """Return the same in pixels of a picture of that size, which has bars around this one."""


Known = TypeVar("Known", bound=PerFrame)


class Video:
    """A clip: one reader that can be iterated again and again, always in order.

    Each pass decodes the file once. It yields deinterlaced frames without the black bars that
    `cut_bars` found, and without duplicates (`curlshot.vision.video.duplicates`). `Frame.index`
    counts the decoded frames of the container, duplicates among them.

    If the clip was converted between frame rates by repeating frames, the end of the first pass
    shows it (`telecine`). Later passes yield the original frames at their original, even times;
    `retime` puts the times of the first pass right.

    Parameters
    ----------
    source : Source
        Gives the decoded frames.

    Attributes
    ----------
    bars : (int, int)
        Widths of the black bars that are cut off: at either side, and at top and bottom, px.
    telecine : Telecine or None
        When the frames were taken, if that is not when they are shown and a pass has found it.
    duplicates : dict of int to Duplicate
        The frames that the latest pass left out because they repeat one before.
    read, decoded : int
        How many frames the latest pass has yielded and decoded so far.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.bars = (0, 0)
        self.telecine: Telecine | None = None
        self.duplicates: dict[int, Duplicate] = {}
        self.read = self.decoded = 0

    @property
    def files(self) -> tuple[Path, ...]:
        """One video, a project, or the pictures in their order."""
        return self.source.files

    @property
    def fps(self) -> float | None:
        """Nominal rate, 1/s; None for a single picture."""
        return self.source.fps

    @property
    def whole_size(self) -> tuple[int, int]:
        """Width and height of the decoded frames, px."""
        return self.source.size

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the frames that iterating yields, without bars, px."""
        (width, height), (beside, above) = self.source.size, self.bars
        return width - 2 * beside, height - 2 * above

    @property
    def first(self) -> int:
        """Number of the first frame of the range that is used."""
        return self.source.first

    @property
    def expected(self) -> int:
        """How many frames a pass should decode."""
        return self.source.expected

    @property
    def warnings(self) -> list[str]:
        """What could not be read, or was left out; filled while reading."""
        return self.source.warnings

    def cut_bars(self, progress: Progress = no_progress) -> None:
        """Find black bars, to be cut off from now on.

        A house that bars cut would be sought in them. Key frames show the bars; all frames are
        decoded for that only where the key frames are dark.
        """
        self.bars = find_bars(self.source, progress)

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in order, without bars and duplicates."""
        hidden = False
        for frame in self.uncut():
            if not hidden and hides(frame.picture, self.bars):
                hidden = True
                self.source.warn(
                    f"{self.files[0]}: black bars are cut off, but frame {frame.index} has"
                    " content there; select the frames of the shot (`frames`)"
                )
            yield replace(frame, picture=without_bars(frame.picture, self.bars))

    def uncut(self) -> Iterator[Frame]:
        """Yield the frames in order, without duplicates, with black bars."""
        known, duplicates = self.telecine, DuplicateFilter()
        self.read, self.decoded, self.duplicates = 0, 0, duplicates.left_out
        for frame in duplicates.distinct(self._counted()):
            if known is not None and frame.index not in known.times:
                continue
            self.read += 1
            yield frame if known is None else replace(frame, t=known.times[frame.index])
        self.telecine = find_telecine(duplicates.shown)
        if self.telecine is not None:
            self.duplicates = self.duplicates | self.telecine.duplicates
        if self.duplicates:
            self.source.warn(
                f"{self.files[0]}: {len(self.duplicates)} of {self.decoded} frames repeat the one"
                f" before; nothing is measured in them{_conversion(self.telecine)}"
            )

    def _counted(self) -> Iterator[Frame]:
        for frame in self.source:
            self.decoded += 1
            yield frame

    def retime(self, known: Sequence[Known]) -> tuple[Known, ...]:
        """Return what a pass found in its frames, at the true times of these.

        The first pass over a telecined clip takes frames for new that repeat another: they are
        left out.
        """
        if self.telecine is None:
            return tuple(known)
        times = self.telecine.times
        return tuple(one.retimed(times[one.frame]) for one in known if one.frame in times)

    def finish(self, known: Sequence[Known]) -> tuple[Known, ...]:
        """Return what a pass found in its frames, for all decoded frames and their pixels.

        Times are put right, duplicates get what is known of the frame that they repeat, and black
        bars are put back.

        Parameters
        ----------
        known : sequence of PerFrame
            One per frame that was yielded, some may be absent, in pixels of that frame.
        """
        by_frame = {one.frame: one for one in self.retime(known)}
        for frame, (t, of) in sorted(self.duplicates.items()):
            if of in by_frame:
                by_frame[frame] = by_frame[of].repeated(frame, t)
        in_order = (by_frame[frame] for frame in sorted(by_frame))
        if not any(self.bars):
            return tuple(in_order)
        return tuple(one.padded(self.bars, self.whole_size) for one in in_order)


def _conversion(telecine: Telecine | None) -> str:
    """Return what a warning says of a conversion between frame rates."""
    if telecine is None:
        return ""
    return (
        f"; the clip was converted from {telecine.rate:.4g} to {telecine.shown_rate:.4g} frames a"
        " second, and the original even times are restored"
    )


def open_video(paths: Sequence[Path], config: VideoConfig = VideoConfig()) -> Video:
    """Open a clip: a video, pictures in the order given, or a Tracker project with its clip.

    Parameters
    ----------
    paths : sequence of Path
        One video, one project, or one or more pictures.
    config : VideoConfig
        Rate of pictures, and the range of frames to use.

    Raises
    ------
    InputError
        A file that is missing, empty or cannot be read as what it is.
    """
    kinds = [path.suffix.lower() for path in paths]
    if SPREADSHEETS.intersection(kinds):
        raise InputError(f"{paths[0]}: {SPREADSHEET}")
    if not TABLE_SUFFIXES.intersection(kinds):
        return Video(open_source(paths, config))
    if len(paths) > 1 or kinds[0] not in PROJECT_SUFFIXES:
        odd = paths[0] if kinds[0] not in PROJECT_SUFFIXES else paths[1]
        raise InputError(f"{odd}: not a clip; name a video, pictures, or one Tracker project")
    from curlshot.vision.video.project_steps import ProjectSteps

    return Video(ProjectSteps.open(paths[0], config))
