"""Duplicate frames: a frame that shows the one before again has no measurement of its own time.

A recording of 25 frames a second that is shown as one of 50 has each twice, one shown as 30 every
fifth; a stream that halts shows one for a while. A duplicate, coded again, differs from the frame
before by far less than where something moved just before and just after. At the end of the clip
only what moved just before counts.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt

import cv2
import numpy as np

from curlshot.data.measurement import Duplicate
from curlshot.vision.video.frame import Frame
from curlshot.vision.video.picture import Image, Picture, Planes
from curlshot.vision.video.telecine import Shown

PLACES = 16000
"""Pixels, about, by which two frames are compared."""

SHARE, FEW_SHARE = 0.2, 0.4
"""Most that a duplicate changes, as a share of the changes before and after: on the whole, and at
a few places. Where the camera halts for a moment a stone goes on at a few places."""

MOVED = 16.0
"""Levels of 255 by which some places change where something moves: coding changes less."""

NEW_SHARE = 0.4
"""Share of the usual change from which on a frame is surely new: grain that is coded again comes to
a third."""

MOST = 32
"""Most frames in a row that are held back till it shows whether to leave them out: for memory."""

HALT = 3
"""Fewest duplicates in a row where a recording halts: fewer come from a conversion of rates."""

FEW = 4
"""Places that change where something moves, at least: a stone that moves by a pixel covers them."""


@dataclass(frozen=True, eq=False)
class Change:
    """How much two frames differ.

    Attributes
    ----------
    away : ndarray of uint8
        At each of the places by which they are compared, levels of 255.
    """

    away: Image

    @cached_property
    def whole(self) -> float:
        """The change on the whole, root mean square."""
        return cv2.norm(self.away) / sqrt(self.away.size)

    @cached_property
    def few(self) -> float:
        """The change at the few places that change most."""
        places = self.away.ravel().copy()
        # The largest of bytes is found a few times in a fraction of the time of ranking them.
        for _ in range(FEW - 1):
            places[places.argmax()] = 0
        return float(places.max())

    def is_tiny(self, others: Sequence[Change]) -> bool:
        """Return whether it is next to nothing compared with others, of something that moved."""
        if self.whole >= SHARE * _usual(other.whole for other in others):
            return False  # as a rule; few places take longer to ask
        few = _usual(other.few for other in others)
        return self.few < FEW_SHARE * few and few >= MOVED

    def goes_on(self, others: Sequence[Change]) -> bool:
        """Return whether something moved, about as much as it did in others."""
        usual = _usual(other.whole for other in others)
        return self.whole > NEW_SHARE * usual and self.few >= MOVED


@dataclass
class DuplicateFilter:
    """Leaves out frames that repeat one before, where something moves.

    Where nothing moves all frames are equal, and each is a measurement of a scene at rest.

    Attributes
    ----------
    left_out : dict of int to Duplicate
        The frames that were left out.
    shown : list of Shown
        Of each frame whether it is new, to find a telecine by; unknown in a halt.
    """

    left_out: dict[int, Duplicate] = field(default_factory=dict)
    shown: list[Shown] = field(default_factory=list)
    _changes: deque[Change] = field(default_factory=lambda: deque(maxlen=9))

    def distinct(self, frames: Iterable[Frame]) -> Iterator[Frame]:
        """Yield the frames in order, without those that `leaves_out` at once."""
        held: list[tuple[Frame, Change]] = []
        last, kept, so_was_last = -1, None, True
        seen: Image = np.zeros(0, np.uint8)
        for frame in frames:
            before, seen = seen, _sample(frame.picture)
            differs, new = 0.0, False
            if kept is not None:
                change = changed(kept, seen)
                if len(held) < MOST and self._may_repeat(change, len(held)):
                    held.append((frame, change))
                    continue
                repeat = bool(held) and all(one.is_tiny([change]) for _, one in held)
                again = False if repeat and len(held) < HALT else None
                self.shown += [Shown(one.index, one.t, again, by.whole) for one, by in held]
                if repeat and leaves_out(len(held), so_was_last):
                    self.left_out |= {one.index: Duplicate(one.t, last) for one, _ in held}
                else:
                    yield from (one for one, _ in held)
                if held and not repeat:
                    self._changes.extend(one for _, one in held)
                    change = changed(before, seen)
                differs, new = change.whole, bool(self._changes) and change.goes_on(self._changes)
                self._changes.append(change)
                held, so_was_last = [], repeat
            last, kept = frame.index, seen
            self.shown.append(Shown(frame.index, frame.t, new or None, differs))
            yield frame
        # Nothing follows to compare with. A scene that comes to rest slows down before.
        self.shown += [Shown(one.index, one.t, None, by.whole) for one, by in held]
        moved = [*self._changes][-1:]
        repeat = bool(moved) and all(one.is_tiny(moved) for _, one in held)
        if repeat and leaves_out(len(held), so_was_last):
            self.left_out |= {one.index: Duplicate(one.t, last) for one, _ in held}
        else:
            yield from (one for one, _ in held)

    def _may_repeat(self, change: Change, held: int) -> bool:
        """Return whether a change is next to nothing compared with those of late.

        At first only the next frames show what these are.
        """
        if self._changes:
            return change.is_tiny(self._changes)
        return held + 1 < HALT and change.few < MOVED


def _usual(values: Iterable[float]) -> float:
    """Return the third largest, or the middle one of a few: a cut or a flash makes one or two."""
    ranked = sorted(values)
    return ranked[-min(3, (len(ranked) + 1) // 2)]


def leaves_out(count: int, so_was_last: bool) -> bool:
    """Return whether duplicates in a row are left out as soon as they are seen.

    A single one now and then is not. Where every fifth frame is repeated to make 30 a second of
    24, the others are shown up to a frame late, more and more from one duplicate to the next. Only
    the telecine, known in the end, gives their times. Without it the duplicate stays: it shows how
    uncertain the times are.

    Parameters
    ----------
    count : int
        How many repeat the same frame.
    so_was_last : bool
        Whether the new frame before that one was repeated as well.
    """
    return so_was_last or count >= HALT


def changed(one: Image, other: Image) -> Change:
    """Return the change between the same places of two frames, whatever the shape."""
    return Change(np.asarray(cv2.absdiff(one, other), np.uint8))


def _sample(picture: Picture) -> Image:
    """Return the lightness at places evenly over a picture."""
    light = picture.luma if isinstance(picture, Planes) else picture[:, :, 1]
    step = max(round((light.size / PLACES) ** 0.5), 1)
    return light[step // 2 :: step, step // 2 :: step].copy()
