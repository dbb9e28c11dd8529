"""Where the painted lines may be measured in a picture: places on them, and their normals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import CIRCLES, HOG_LINE, LEFT, RIGHT, ice_frame, measures
from curlshot.vision.optics.pose import project
from curlshot.vision.optics.rig import HOG_Y
from curlshot.vision.sheet.stations import BLOCK, ON_ALL, ON_ALL_DOWN, ON_CIRCLES, THIN, Stations

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
Profiles = NDArray[np.float32]

SAMPLES = 25
"""Samples along a normal; odd, the middle one at the point itself."""

_SHARES = np.linspace(-1.0, 1.0, SAMPLES, dtype=np.float32)

LINE_REACH = 0.06
"""Half width looked at across a thin line, m: some are painted as two stripes 3 cm apart."""

BAND = 0.05
"""Half width looked at across the edges of the hog line and of the sheet's sides, m: half of what
is painted there, so that however far it is blurred or away, its other edge does not draw this one
aside."""

MOST_BLOCKS, MOST_STEPS = 18, 40
"""Most marks of a thin line, and of the edge of a wide one."""

MOST_MOVED, LEAST_LEFT = 0.03, 0.9
"""How far the same normals may move from where they were laid out, in widths of the picture, and
the least share of them that must then be in it."""

_LITTLE = 1e-3
"""A stretch over which every line is straight, m or rad."""

OUTSIDE = -1e4
"""Coordinate of what is no longer in the picture, px: nothing is seen there."""

LEAST, LEAST_BLOCKS = 8, 3
"""Fewer normals than this are no line; of a thin line, fewer blocks."""


def means_of_ends(count: int) -> Profiles:
    """Matrix, (2, SAMPLES), that takes the means of so many samples at either end of a profile."""
    ends = np.zeros((2, SAMPLES), np.float32)
    ends[0, :count] = ends[1, -count:] = 1 / count
    return ends


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
        Where along its line, as in `curlshot.vision.optics.paint.Marks`.
    foot, way : ndarray, shape (2, n)
        Where it is on the ice, as in `curlshot.vision.optics.paint.ice_frame`.
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
    magnified : ndarray, shape (n,)
        How much larger than usual what lies across a circle looks there; 1 on lines.
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
    magnified: Array
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
        places = np.empty((2, 2 * count))
        places[:, :count], places[:, count:] = foot + way * measure, foot_on + way_on * measure
        seen = project(places.T, view, rig, size).T
        point, (across, down) = seen[:, :count], seen[:, count:] - seen[:, :count]
        if not np.abs(point - self.point).max() < MOST_MOVED * size[0]:
            return None
        inside = _within(point, self.wanted, size)
        if not inside.all():
            blocks = inside[self.wide :].reshape(-1, BLOCK)
            inside[self.wide :] = np.repeat(blocks.all(1), BLOCK)
            if inside.mean() < LEAST_LEFT:
                return None
            point[:, ~inside] = OUTSIDE
        length = np.sqrt(across * across + down * down)
        return np.array([point, [down / length, -across / length]])


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
        Camera as in `curlshot.vision.optics.pose` and `curlshot.vision.optics.rig`.
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
    on = (ON_ALL if rig[HOG_Y] > 0 else ON_ALL_DOWN) if lines else ON_CIRCLES
    measure = measures(rig)[on.line]
    place = project((on.foot + on.way * measure).T, view, rig, size).T
    across, down = place[:, on.ahead] - place[:, on.behind]
    length = np.sqrt(across * across + down * down)
    inside = _within(place, reach, size)
    shown = np.add.reduceat(inside, on.start, dtype=np.int64)
    span = np.add.reduceat(np.where(inside, length, 0.0), on.start) / 2
    scale = span / np.maximum(shown * on.spacing, 1e-9)
    thin, hog = on.group > 1, on.kind == HOG_LINE
    wanted = np.where(thin, min(most // 6, MOST_BLOCKS), min(most // 2, MOST_STEPS))
    wanted[:CIRCLES] = np.clip(span[:CIRCLES] / spacing, 12, most)
    kept = _thinned(inside, wanted, on)
    at = np.flatnonzero(np.repeat(kept, on.group_size))
    counts = on.group * np.add.reduceat(kept, on.first_group, dtype=np.int64)
    ends = np.cumsum(counts)
    kinds = {
        int(kind): slice(int(end - n), int(end))
        for kind, n, end in zip(on.kind, counts, ends, strict=True)
        if n
    }
    reaches = np.full(len(counts), reach)
    reaches[thin] = np.maximum(reach, LINE_REACH * scale[thin])
    reaches[hog] = np.minimum(reach, BAND * scale[hog])
    normal = np.stack([down[at], -across[at]]) / length[at]
    reaches = np.fmin(np.repeat(reaches, counts), _beside(place, measure, on.line)[at])
    samples = _SHARES[:, None] * (normal * reaches).astype(np.float32)[:, None]
    return Normals(
        kinds, on.line[at], on.along[at], on.foot[:, at], on.way[:, at], place[:, at], normal,
        reach, reaches, shown[:CIRCLES] / on.count[:CIRCLES],
        _magnified(place, measure, on, at, normal), samples,
    )  # fmt: skip


def _magnified(place: Array, measure: Array, on: Stations, at: Index, normal: Array) -> Array:
    """How large what lies across the circles looks at some stations, by how far apart these are."""
    number, found = int(on.count[:CIRCLES].sum()), np.ones(len(at))
    rings = place[:, :number].reshape(2, CIRCLES, -1)
    outward = np.array(np.gradient(rings, measure[on.start[:CIRCLES]], axis=1)).reshape(2, -1)
    circles = at < number
    if circles.any():
        size = np.abs((outward[:, at[circles]] * normal[:, circles]).sum(0))
        found[circles] = size / np.mean(size)
    return found


def _within(place: Array, margin: float, size: tuple[int, int]) -> Flags:
    """Whether places, (2, n), lie in the picture, so far from its rim."""
    (x, y), (w, h) = place, size
    return np.asarray(
        (x > margin) & (y > margin) & (x < w - 1 - margin) & (y < h - 1 - margin), bool
    )


def _beside(place: Array, measure: Array, line: Index) -> Array:
    """Half widths to look at across the sheet's sides, px; inf elsewhere, NaN by one not seen."""
    bound = np.full(len(line), np.inf)
    left, right = line == LEFT, line == RIGHT
    across = np.hypot(*(place[:, right] - place[:, left]))
    bound[left] = bound[right] = BAND * across / (measure[right] - measure[left])
    return bound


def _thinned(inside: Flags, wanted: Index, on: Stations) -> Flags:
    """Keep so many groups on each line as are wanted of those that lie inside."""
    whole = np.logical_and.reduceat(inside, on.group_start)
    share, first = whole * on.share, on.first_group
    total = np.cumsum(share)
    number = total - share - np.repeat(total[first] - share[first], on.groups)
    have = np.add.reduceat(whole, first, dtype=np.int64)
    shares = np.add.reduceat(share, first, dtype=np.int64)
    enough = have >= np.where(on.group > 1, LEAST_BLOCKS, LEAST)
    ratio = np.repeat(np.minimum(wanted / np.maximum(shares, 1), 1.0) * enough, on.groups)
    # Of those in each equal share of a line the middle one: both ends are alike.
    before, after = (np.floor(n * ratio + 0.5) for n in (number, number + share))
    return np.asarray(whole & (after > before))
