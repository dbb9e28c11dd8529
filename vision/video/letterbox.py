"""Letterboxes and pillarboxes: black bars around a picture.

Bars of the same width on both sides leave the lens's axis in the middle. Uneven ones are taken for
part of the picture.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from curlshot.data.progress import Progress, no_progress
from curlshot.vision.video.picture import Image, Picture, Planes
from curlshot.vision.video.source import Source

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


def find_bars(source: Source, progress: Progress = no_progress) -> tuple[int, int]:
    """Return even widths of the bars at either side, and at top and bottom, px; 0 where none are.

    Key pictures, at each cut and every few seconds, show them. Where these are dark or dim, all
    are decoded.
    """
    first = source.peek()
    if first is None:
        return 0, 0
    shown = _together(_shown(first), source.key_pictures())
    if shown[2] < DIM:
        progress("black bars", 0, 1)
        shown = _together(shown, (frame.picture for frame in source))
    return _bar(shown[0]), _bar(shown[1])


def hides(picture: Picture, bars: tuple[int, int]) -> bool:
    """Return whether a picture, which `find_bars` may not have seen, is not black at its borders.

    Only borders that `bars` would cut off count.
    """
    if not any(bars):
        return False
    values = _values(picture)
    lit = _lit(values[:, [0, -1]]).mean(0), _lit(values[[0, -1]]).mean(1)
    return any(bar and ends.max() > MARKED for bar, ends in zip(bars, lit, strict=True))


def without_bars(picture: Picture, bars: tuple[int, int]) -> Picture:
    """Return a picture without bars of even widths, at either side and at top and bottom."""
    if not any(bars):
        return picture
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
    """Return how much of a picture is not black, and how light it is."""
    values = _values(picture)
    lit, light = _lit(values), values if values.ndim == 2 else values.max(2)
    return lit.mean(0), lit.mean(1), np.percentile(light[::4, ::4], [95])


def _values(picture: Picture) -> Image:
    """Return luma, or blue, green and red, of a picture."""
    return picture.luma if isinstance(picture, Planes) else picture


def _lit(values: Image) -> Flags:
    """Return which pixels are not black."""
    return np.asarray(values > BLACK_LUMA if values.ndim == 2 else values.max(2) > BLACK)


def _together(shown: Shown, pictures: Iterable[Picture]) -> Shown:
    """Return the most that any picture shows in each column and row, till no bars are left."""
    left = iter(pictures)
    while any(lit[[0, -1]].max() <= MARKED for lit in shown[:2]):
        more = next(left, None)
        if more is None:
            break
        columns, rows, light = map(np.maximum, shown, _shown(more))
        shown = columns, rows, light
    return shown


def _bar(lit: Shares) -> int:
    """Return the width of the bars at either end, px, to an even number; 0 where there are none."""
    for share, beside in ((SHARE, 0.0), (MARKED, FILLED)):
        first, last = int((lit > share).argmax()), int((lit > share)[::-1].argmax())
        width = max(first, last)
        if abs(first - last) > UNEVEN or not LEAST < width / len(lit) < MOST:
            continue
        if lit[[width + UNEVEN, -1 - width - UNEVEN]].min() > beside:
            return width + width % 2
    return 0
