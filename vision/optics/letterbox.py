"""Letterboxes and pillarboxes: black bars around a picture, cut off before a house is sought.

A house that they cut would be sought in them. So such a clip is looked at without them, as one
that ends where they begin, and its cameras are told in pixels of the whole picture. Bars of the
same width on both sides leave the lens's axis in the middle; others are taken for picture.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.progress import Progress, no_progress
from curlshot.vision.film.clip import Clip, Frame
from curlshot.vision.film.picture import Image, Picture, Planes
from curlshot.vision.optics.camera import Camera
from curlshot.vision.optics.projection import middle

Flags = NDArray[np.bool_]
Shares = NDArray[np.float64]
Shown = tuple[Shares, Shares, Shares]
"""Share of each column and of each row that is not black, and how light the lightest part is."""

BLACK_LUMA, BLACK = 24, 10
"""Up to which luma, and up to which blue, green and red, it is black; as coded, black is 16."""

SHARE, MARKED, FILLED = 0.05, 0.3, 0.6
"""Share of a row or column that is not black where there is picture, coded coarsely, for what is
beside it has traces of it; up to which a title or somebody's mark may fill a bar (bold letters over
two thirds of it); and from which on there is picture right beside such a bar. A sheet that goes
aslant through a dark hall has no such edge."""

DIM = 100
"""Of a picture whose lightest twentieth is darker than this hardly more is to be seen than its ice:
it fades in or out, and what is black in it need not be bars."""

UNEVEN = 4
"""By how many px bars on either side may differ."""

LEAST, MOST = 0.02, 0.4
"""What share of a picture's width or height a bar has."""


class LitClip(Clip):
    """A clip without its black bars.

    Parameters
    ----------
    whole : Clip
    bars : tuple of int
        Even widths of the bars at either side, and at top and bottom, px.
    """

    def __init__(self, whole: Clip, bars: tuple[int, int]) -> None:
        (w, h), (aside, above) = whole.size, bars
        super().__init__(
            whole.files, (w - 2 * aside, h - 2 * above), whole.fps, whole.frames, whole.first,
            whole.last, whole.warnings,
        )  # fmt: skip
        self.whole, self.bars = whole, bars

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in order, without the bars."""
        hidden = False
        for frame in self.whole:
            self.read, self.passed = self.whole.read, self.whole.passed
            if not hidden and self._hides(frame.picture):
                hidden = True
                self._warn(
                    f"{self.files[0]}: black bars are cut off, but frame {frame.index} has"
                    " content there; select the frames of the shot (`frames`)"
                )
            yield Frame(frame.index, frame.t, without_bars(frame.picture, self.bars))
        self.cadence = self.whole.cadence

    def _hides(self, picture: Picture) -> bool:
        """Whether a picture, which may not have been asked, shows something to its borders."""
        values = _values(picture)
        lit = _lit(values[:, [0, -1]]).mean(0), _lit(values[[0, -1]]).mean(1)
        return any(bar and ends.max() > MARKED for bar, ends in zip(self.bars, lit, strict=True))


def lit_clip(clip: Clip, progress: Progress = no_progress) -> Clip:
    """Give a clip without its black bars; itself where it has none.

    Pictures coded by themselves, at each cut and every few seconds, are asked, and all if those
    are dark or dim.
    """
    first = clip.peek()
    if first is None:
        return clip
    shown = _together(_shown(first), clip.key_pictures())
    if shown[2] < DIM:
        progress("black bars", 0, 1)
        shown = _together(shown, (frame.picture for frame in clip.every()))
    bars = _bar(shown[0]), _bar(shown[1])
    return LitClip(clip, bars) if any(bars) else clip


def in_whole(clip: Clip, cameras: Sequence[Camera]) -> tuple[Clip, tuple[Camera, ...]]:
    """Give a clip with its bars, and its cameras in pixels of that."""
    if not isinstance(clip, LitClip):
        return clip, tuple(cameras)
    return clip.whole, tuple(_with_bars(one, clip.bars, clip.whole.size) for one in cameras)


def without_bars(picture: Picture, bars: tuple[int, int]) -> Picture:
    """Cut bars of even widths, at either side and at top and bottom, off a picture."""
    if isinstance(picture, Planes):
        luma, blue, red = (
            _inner(plane, bars[0] // share, bars[1] // share)
            for plane, share in ((picture.luma, 1), (picture.blue, 2), (picture.red, 2))
        )
        return replace(picture, luma=luma, blue=blue, red=red, frame=None)
    return _inner(picture, *bars)


def _inner(values: Image, aside: int, above: int) -> Image:
    height, width = values.shape[:2]
    return values[above : height - above, aside : width - aside]


def _shown(picture: Picture) -> Shown:
    """Tell how much of a picture is not black, and how light it is."""
    values = _values(picture)
    lit, light = _lit(values), values if values.ndim == 2 else values.max(2)
    return lit.mean(0), lit.mean(1), np.percentile(light[::4, ::4], [95])


def _values(picture: Picture) -> Image:
    """Luma, or blue, green and red, of a picture."""
    return picture.luma if isinstance(picture, Planes) else picture


def _lit(values: Image) -> Flags:
    """Which pixels are not black."""
    return np.asarray(values > BLACK_LUMA if values.ndim == 2 else values.max(2) > BLACK)


def _together(shown: Shown, pictures: Iterable[Picture]) -> Shown:
    """Most that any picture shows in each column and row, till no bars are left at either end."""
    left = iter(pictures)
    while any(lit[[0, -1]].max() <= MARKED for lit in shown[:2]):
        more = next(left, None)
        if more is None:
            break
        columns, rows, light = map(np.maximum, shown, _shown(more))
        shown = columns, rows, light
    return shown


def _bar(lit: Shares) -> int:
    """Width of the bars at either end, px, to an even number; 0 where there are none."""
    for share, beside in ((SHARE, 0.0), (MARKED, FILLED)):
        first, last = int((lit > share).argmax()), int((lit > share)[::-1].argmax())
        width = max(first, last)
        if abs(first - last) > UNEVEN or not LEAST < width / len(lit) < MOST:
            continue
        if lit[[width + UNEVEN, -1 - width - UNEVEN]].min() > beside:
            return width + width % 2
    return 0


def _with_bars(seen: Camera, bars: tuple[int, int], size: tuple[int, int]) -> Camera:
    """Give a camera in pixels of a picture of that size, of which it has seen all but the bars."""
    moved = np.eye(3)
    moved[:2, 2] = bars
    # The lens's axis is in the middle of both, but distortion is told in half diagonals.
    grown = (middle(size)[1] / middle(seen.size)[1]) ** 2
    by = np.diag([*np.ones(7), grown, grown**2])
    error = seen.error
    if error is not None:
        error = replace(error, shared=by @ error.shared @ by, own=by @ error.own @ by)
    return replace(
        seen, homography=moved @ seen.homography, size=size, k1=grown * seen.k1,
        k2=grown**2 * seen.k2, error=error,
    )  # fmt: skip
