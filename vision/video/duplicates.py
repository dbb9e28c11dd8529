"""Duplicate frames: pictures that show the one before once more tell nothing of their own time.

A recording of 25 pictures a second that is told as one of 50 has each twice, one told as 30 every
fifth; a stream that halts shows one for a while. Coded anew, the second differs from the first by
far less than where something moved just before and just after.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING

import cv2
import numpy as np

from curlshot.vision.video.picture import Image, Picture, Planes
from curlshot.vision.video.telecine import Shown

if TYPE_CHECKING:
    from curlshot.vision.video.reader import Frame

PLACES = 16000
"""Pixels, about, by which two pictures are compared."""

SHARE, FEW_SHARE = 0.2, 0.4
"""Parts of the changes before and after, on the whole and at a few places, below which a picture
repeats another. On the whole, of 190 clips those that repeat none come to 0.35 and more, repeats
coded anew to 0.15 and less; where the camera halts for a moment a stone goes on at a few places."""

MOVED = 16.0
"""Levels of 255 by which some places change where something moves: less is what coding changes."""

NEW_SHARE = 0.4
"""Part of the changes of late from which on a picture is surely a new one: grain that is coded anew
comes to a third."""

MOST = 32
"""Pictures in a row held back till it shows whether to leave them out, at most: for memory."""

HALT = 3
"""Repeats in a row where a recording halts, at least: fewer are a matter of rates."""

FEW = 4
"""Places that change so, at least: a stone that moves by a pixel covers as many."""


@dataclass(frozen=True, eq=False)
class Change:
    """How much two pictures differ.

    Attributes
    ----------
    away : ndarray of uint8
        At each of the places by which they are compared, levels of 255.
    """

    away: Image

    @cached_property
    def whole(self) -> float:
        """By how much on the whole, root mean square."""
        return cv2.norm(self.away) / sqrt(self.away.size)

    @cached_property
    def few(self) -> float:
        """By how much at a few places."""
        places = self.away.ravel().copy()
        # The largest of bytes is found a few times in a fraction of the time of ranking them.
        for _ in range(FEW - 1):
            places[places.argmax()] = 0
        return float(places.max())

    def beside(self, others: Sequence[Change]) -> bool:
        """Whether it is next to nothing beside others, of something that moved."""
        if self.whole >= SHARE * _usual(other.whole for other in others):
            return False  # as a rule; few places take longer to ask
        few = _usual(other.few for other in others)
        return self.few < FEW_SHARE * few and few >= MOVED

    def goes_on(self, others: Sequence[Change]) -> bool:
        """Whether something moved, about as much as it did in others."""
        usual = _usual(other.whole for other in others)
        return self.whole > NEW_SHARE * usual and self.few >= MOVED


@dataclass
class Repeats:
    """Leaves out of frames those that repeat one before, where something moves.

    Where nothing moves all pictures are alike, and each shows that it is so.

    Attributes
    ----------
    left_out : dict of int to (float, int)
        Of each frame that was left out its time, s, and the frame that it repeats.
    shown : list of Shown
        Of each frame whether it shows a new picture, for a cadence to be told by in the end. A
        halt says nothing of it.
    """

    left_out: dict[int, tuple[float, int]] = field(default_factory=dict)
    shown: list[Shown] = field(default_factory=list)
    _changes: deque[Change] = field(default_factory=lambda: deque(maxlen=9))

    def distinct(self, frames: Iterable[Frame]) -> Iterator[Frame]:
        """Give the frames in order, without those that `tell_nothing`."""
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
                repeat = bool(held) and all(one.beside([change]) for _, one in held)
                again = False if repeat and len(held) < HALT else None
                self.shown += [Shown(one.index, one.t, again, by.whole) for one, by in held]
                if repeat and tell_nothing(len(held), so_was_last):
                    self.left_out |= {one.index: (one.t, last) for one, _ in held}
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
        self.shown += [Shown(one.index, one.t, None, by.whole) for one, by in held]
        yield from (one for one, _ in held)

    def _may_repeat(self, change: Change, held: int) -> bool:
        """Whether a change is next to nothing beside those of late.

        At first only the next pictures can tell what these are.
        """
        if self._changes:
            return change.beside(self._changes)
        return held + 1 < HALT and change.few < MOVED


def _usual(values: Iterable[float]) -> float:
    """Give the third largest, or of a few the middle one, for a cut or a flash makes one or two."""
    ranked = sorted(values)
    return ranked[-min(3, (len(ranked) + 1) // 2)]


def tell_nothing(count: int, so_was_last: bool) -> bool:
    """Whether pictures that repeat one before are to be left out as soon as they are seen.

    Not a single one now and then: where every fifth is repeated to make 30 a second of 24, the
    others are told up to a frame late, more and more from one repeat to the next. In the end their
    `cadence` may tell when they were taken; else stones would seem faster than they are if the
    repeat did not say how unsure times are.

    Parameters
    ----------
    count : int
        How many repeat it.
    so_was_last : bool
        Whether the picture before it was repeated as well.
    """
    return so_was_last or count >= HALT


def changed(one: Image, other: Image) -> Change:
    """Compare two pictures by the same places of each, whatever the shape."""
    return Change(np.asarray(cv2.absdiff(one, other), np.uint8))


def _sample(picture: Picture) -> Image:
    """Lightness at places evenly over a picture."""
    light = picture.luma if isinstance(picture, Planes) else picture[:, :, 1]
    step = max(round((light.size / PLACES) ** 0.5), 1)
    return light[step // 2 :: step, step // 2 :: step].copy()
