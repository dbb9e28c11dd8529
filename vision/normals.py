"""Where the painted lines may be measured in a picture: places on them, and their normals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE, SHEET
from vision.paint import (
    BACK_LINE,
    CENTRE_LINE,
    CIRCLES,
    HOG_LINE,
    LEFT,
    RIGHT,
    TEE_LINE,
    ice_frame,
    measures,
)
from vision.pose import project

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
Profiles = NDArray[np.float32]

THIN = (CENTRE_LINE, TEE_LINE, BACK_LINE)
"""Lines a centimetre or two wide; all others are edges between two colours."""

SAMPLES = 25
"""Samples along a normal; odd, the middle one at the point itself."""

_SHARES = np.linspace(-1.0, 1.0, SAMPLES, dtype=np.float32)

LINE_REACH = 0.06
"""Half width looked at across a thin line, m: some are painted as two stripes 3 cm apart."""

BAND = 0.05
"""Half width looked at across the edges of the hog line and of the sheet's sides, m: half of what
is painted there, so that however far it is blurred or away, its other edge does not draw this one
aside."""

BLOCK = 6
"""Neighbouring normals of a thin line that are measured together."""

MOST_BLOCKS, MOST_STEPS = 18, 40
"""Most marks of a thin line, and of the edge of a wide one."""

MOST_MOVED, LEAST_LEFT = 0.03, 0.9
"""How far the same normals may move from where they were laid out, in widths of the picture, and
the least share of them that must then be in it."""

_LITTLE = 1e-3
"""A stretch over which every line is straight, m or rad."""

OUTSIDE = -1e4
"""Coordinate of what is no longer in the picture, px: nothing is seen there."""

CLOSER = 4
"""How much closer blocks lie beyond the house: some lines are painted there alone, and end soon."""

LEAST, LEAST_BLOCKS = 8, 3
"""Fewer normals than this are no line; of a thin line, fewer blocks."""


def _candidates() -> list[tuple[int, Array]]:
    """Kinds of line, and the places along each where it may be measured."""
    angle = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    lengthwise = np.arange(-4.0, SHEET.hog_line + 3, 0.04)
    across = np.arange(-SHEET.half_width_min, SHEET.half_width_min, 0.03)
    # Between, the 12-ft circle touches the back line.
    beside = _blocks(np.arange(0.76, SHEET.half_width_min, 0.03))
    return [
        *((kind, angle) for kind in range(CIRCLES)),
        (LEFT, lengthwise[::3]),
        (RIGHT, lengthwise[::3]),
        (HOG_LINE, across[::2]),
        (CENTRE_LINE, _blocks(lengthwise)),
        (TEE_LINE, _blocks(across)),
        (BACK_LINE, np.concatenate([-beside[::-1], beside])),
    ]


def _blocks(along: Array) -> Array:
    """Leave out what is no whole block."""
    return along[: len(along) // BLOCK * BLOCK]


_CANDIDATES = _candidates()
_KINDS = np.array([kind for kind, _ in _CANDIDATES])
_SPACING = np.array([along[1] - along[0] for _, along in _CANDIDATES])
_COUNTS = np.array([len(along) for _, along in _CANDIDATES])
_STARTS = np.cumsum(_COUNTS) - _COUNTS
_ALONG = np.concatenate([along for _, along in _CANDIDATES])
_LINE = np.repeat(_KINDS, _COUNTS)
_FOOT, _WAY = ice_frame(_LINE, _ALONG)

# Candidates are kept by groups: on a thin line a block, else one alone.
_GROUP = np.where(np.isin(_KINDS, THIN), BLOCK, 1)
_GROUPS = _COUNTS // _GROUP
_FIRST_GROUP = np.cumsum(_GROUPS) - _GROUPS
_GROUP_SIZE = np.repeat(_GROUP, _GROUPS)
_GROUP_START = np.cumsum(_GROUP_SIZE) - _GROUP_SIZE
_BEYOND = np.abs(_ALONG[_GROUP_START + _GROUP_SIZE // 2]) > HOUSE.twelve_foot
_SHARE = np.where((_GROUP_SIZE > 1) & _BEYOND, CLOSER, 1)


def _neighbours() -> tuple[Index, Index]:
    """Index of the candidate after and before each one on the same line."""
    ahead, behind = np.arange(len(_ALONG)) + 1, np.arange(len(_ALONG)) - 1
    for kind, first, count in zip(_KINDS, _STARTS, _COUNTS, strict=True):
        last, closed = first + count - 1, kind < CIRCLES
        ahead[last] = first if closed else last
        behind[first] = last if closed else first
    return ahead, behind


_AHEAD, _BEHIND = _neighbours()


@dataclass(frozen=True, eq=False)
class Normals:
    """Places on the lines, all inside the picture for which they were laid out.

    Attributes
    ----------
    kinds : dict of int to slice
        Which of the places lie on each kind of line: thin lines come last.
    line : ndarray of int, shape (n,)
        The kind of each.
    along : ndarray, shape (n,)
        Where along its line, as in `vision.paint.Marks`.
    foot, way : ndarray, shape (2, n)
        Where it is on the ice, as in `vision.paint.ice_frame`.
    point : ndarray, shape (2, n)
        Where it was in the picture, px.
    normal : ndarray, shape (2, n)
        The unit normal there.
    wanted : float
        Half length to be looked at as a rule, px.
    reach : ndarray, shape (n,)
        That of each, px.
    visible : ndarray, shape (3,)
        Fraction of each circle inside the picture.
    samples : ndarray of float32, shape (2, SAMPLES, n)
        From the place to the samples along the normal, x and y, px.
    """

    kinds: dict[int, slice]
    line: Index
    along: Array
    foot: Array
    way: Array
    point: Array
    normal: Array
    wanted: float
    reach: Array
    visible: Array
    samples: Profiles

    @property
    def standing(self) -> Array:
        """Places and unit normals in the picture for which they were laid out, (2, 2, n)."""
        return np.stack([self.point, self.normal])

    @cached_property
    def beyond(self) -> tuple[Array, Array]:
        """Foot and way of a place a little farther along the line of each."""
        return ice_frame(self.line, self.along + _LITTLE)

    @property
    def wide(self) -> int:
        """How many come before those of thin lines."""
        thin = (self.kinds[kind].start for kind in THIN if kind in self.kinds)
        return min(thin, default=len(self.line))

    def moved(self, view: Array, rig: Array, size: tuple[int, int]) -> Array | None:
        """Tell where they stand in a picture taken a little later.

        Their samples still lie along the old directions. An edge is found there, too; but how far
        it is from its place is told by the new ones: else turn and shift would mix.

        Returns
        -------
        ndarray, shape (2, 2, n), or None
            As `standing`; `OUTSIDE` where one has left the picture. None where they have moved so
            far that they must be laid out anew.
        """
        if not self.kinds:
            return None
        measure, count = measures(rig)[self.line], len(self.line)
        (foot, way), (foot_on, way_on) = (self.foot, self.way), self.beyond
        places = np.append(foot + way * measure, foot_on + way_on * measure, axis=1)
        seen = project(places.T, view, rig, size).T
        point, (across, down) = seen[:, :count], seen[:, count:] - seen[:, :count]
        if not np.abs(point - self.point).max() < MOST_MOVED * size[0]:
            return None
        reach, (x, y), (w, h) = self.wanted, point, size
        inside = (x > reach) & (y > reach) & (x < w - 1 - reach) & (y < h - 1 - reach)
        if not inside.all():
            blocks = inside[self.wide :].reshape(-1, BLOCK)
            inside[self.wide :] = np.repeat(blocks.all(1), BLOCK)
            if inside.mean() < LEAST_LEFT:
                return None
            point[:, ~inside] = OUTSIDE
        normal = np.stack([down, -across]) / np.sqrt(across * across + down * down)
        return np.stack([point, normal])


def lay_out(
    view: Array,
    rig: Array,
    size: tuple[int, int],
    *,
    reach: float,
    spacing: float = 6.0,
    most: int = 360,
    lines: bool = True,
) -> Normals:
    """Places to measure in a picture.

    Parameters
    ----------
    view, rig : ndarray
        Camera as in `vision.pose` and `vision.rig`.
    size : tuple of int
        Width and height of the picture, px.
    reach : float
        Half length of the normals, px; longer across thin lines, shorter across narrow bands.
    spacing : float
        Distance of neighbouring places on a circle, px.
    most : int
        Places on a circle; where it is small there are fewer on the lines as well.
    lines : bool
        Whether the lines are laid out beside the circles.
    """
    upto = len(_KINDS) if lines else CIRCLES
    count, groups = int(_COUNTS[:upto].sum()), int(_GROUPS[:upto].sum())
    measure = np.repeat(measures(rig)[_KINDS[:upto]], _COUNTS[:upto])
    place = project((_FOOT[:, :count] + _WAY[:, :count] * measure).T, view, rig, size)
    x, y = place.T
    across, down = (v[_AHEAD[:count]] - v[_BEHIND[:count]] for v in (x, y))
    length = np.sqrt(across * across + down * down)
    w, h = size
    inside = (x > reach) & (y > reach) & (x < w - 1 - reach) & (y < h - 1 - reach)
    shown = np.add.reduceat(inside, _STARTS[:upto], dtype=np.int64)
    span = np.add.reduceat(np.where(inside, length, 0.0), _STARTS[:upto]) / 2
    scale = span / np.maximum(shown * _SPACING[:upto], 1e-9)
    wanted = np.where(_GROUP[:upto] > 1, min(most // 6, MOST_BLOCKS), min(most // 2, MOST_STEPS))
    wanted[:CIRCLES] = np.clip(span[:CIRCLES] / spacing, 12, most)
    kept = _thinned(inside, wanted, groups)
    at = np.flatnonzero(np.repeat(kept, _GROUP_SIZE[:groups]))
    counts = _GROUP[:upto] * np.add.reduceat(kept, _FIRST_GROUP[:upto], dtype=np.int64)
    ends = np.cumsum(counts)
    kinds = {
        int(kind): slice(int(end - n), int(end))
        for kind, n, end in zip(_KINDS[:upto], counts, ends, strict=True)
        if n
    }
    reaches = np.full(upto, reach)
    thin, hog = _GROUP[:upto] > 1, _KINDS[:upto] == HOG_LINE
    reaches[thin] = np.maximum(reach, LINE_REACH * scale[thin])
    reaches[hog] = np.minimum(reach, BAND * scale[hog])
    normal = np.stack([down[at], -across[at]]) / length[at]
    reaches = np.fmin(np.repeat(reaches, counts), _beside(place, measure)[at])
    samples = _SHARES[:, None] * (normal * reaches).astype(np.float32)[:, None]
    visible = shown[:CIRCLES] / _COUNTS[:CIRCLES]
    return Normals(
        kinds, _LINE[at], _ALONG[at], _FOOT[:, at], _WAY[:, at], place.T[:, at], normal, reach,
        reaches, visible, samples,
    )  # fmt: skip


def _beside(place: Array, measure: Array) -> Array:
    """Half widths to look at across the sheet's sides, px; inf elsewhere, NaN by one not seen."""
    bound = np.full(len(place), np.inf)
    left, right = (_LINE[: len(place)] == kind for kind in (LEFT, RIGHT))
    across = np.hypot(*(place[right] - place[left]).T)
    bound[left] = bound[right] = BAND * across / (measure[right] - measure[left])
    return bound


def _thinned(inside: Flags, wanted: Index, groups: int) -> Flags:
    """Keep so many groups of each kind as are wanted of those that lie inside."""
    whole = np.logical_and.reduceat(inside, _GROUP_START[:groups])
    first, sizes = _FIRST_GROUP[: len(wanted)], _GROUPS[: len(wanted)]
    share = whole * _SHARE[:groups]
    total = np.cumsum(share)
    number = total - share - np.repeat(total[first] - share[first], sizes)
    have = np.add.reduceat(whole, first, dtype=np.int64)
    shares = np.add.reduceat(share, first, dtype=np.int64)
    enough = have >= np.where(_GROUP[: len(wanted)] > 1, LEAST_BLOCKS, LEAST)
    ratio = np.repeat(np.minimum(wanted / np.maximum(shares, 1), 1.0) * enough, sizes)
    # Of those in each equal share of a line the middle one: both ends are alike.
    before, after = (np.floor(n * ratio + 0.5) for n in (number, number + share))
    return np.asarray(whole & (after > before))
