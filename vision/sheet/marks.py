"""Edges of the painted circles and lines, measured along their normals at sub-pixel precision.

Circles, the sheet's sides and wide lines are edges between two colours
(`curlshot.vision.sheet.edges`); of thin lines the middle is measured
(`curlshot.vision.sheet.stripes`). What is ragged counts less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import CIRCLES, FIXED, TWELVE, Marks
from curlshot.vision.sheet.edges import crossings, steps
from curlshot.vision.sheet.normals import OUTSIDE, SAMPLES, Normals, Profiles, lay_out
from curlshot.vision.sheet.outline import HALF_WAY, PaintEdge
from curlshot.vision.sheet.outlined import outlines, summed
from curlshot.vision.sheet.runs import Curves, Runs, smooth
from curlshot.vision.sheet.stations import BLOCK, THIN
from curlshot.vision.sheet.stripes import Blocks, find_stripes
from curlshot.vision.video.picture import Picture, channels_at

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]

EDGE_SD = 0.45
"""Standard deviation of an edge point with the errors of paint that neighbours share, px."""

LEAST_PAIRS = 3
"""Neighbours on a circle that must both show it to tell how far their edges scatter."""

CLEAR = 0.4
"""Share of a normal that is shorter than the rest within which an edge on it must lie: nearer its
end the colours beside it are the edge's own, and it would be drawn to where it was expected."""

LEAST_ON_LINE, LEAST_SHARE = 8, 0.3
"""Edge points that the side of the sheet or a wide line must have, and the share of normals."""


@dataclass(frozen=True)
class Evidence:
    """Marks measured in a frame, and how much of the circles they cover.

    Attributes
    ----------
    marks : Marks
    visible : ndarray, shape (3,)
        Fraction of each circle inside the picture.
    covered : ndarray, shape (3,)
        Fraction of each circle that has an edge of the circle's own two colours.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge; NaN where none was made out.
    rim : ndarray, shape (SAMPLES, n)
        Profiles across the 12-ft edge, from ice (−0.5) to paint (0.5).
    crossing : ndarray, shape (n,)
        Samples at which the marks on it are; NaN where there is none.
    slope : ndarray, shape (n,)
        Of the profiles there, per px; NaN where there is no mark.
    step : float
        Distance of the samples, px.
    """

    marks: Marks
    visible: Array
    covered: Array
    palette: Array
    rim: Profiles
    crossing: Array
    slope: Array
    step: float

    @property
    def profile(self) -> Array:
        """Mean profile across the 12-ft edge about half way, (SAMPLES,); NaN where unknown.

        There profiles are steepest: about marks at another level, where noise moves them farther,
        their mean would be blurred. Of outlines alone it is the mean about the marks.
        """
        seen = np.isfinite(self.crossing)
        about, _, rises = crossings(self.rim)
        if 2 * (self.rim[-1, seen] > 0).sum() > seen.sum():
            seen &= rises
        else:
            about = self.crossing
        return _mean_profile(self.rim.T[seen], about[seen])

    @cached_property
    def steepness(self) -> float:
        """Usual slope of the profiles across the 12-ft edge, per px; 0 where none is seen."""
        seen = self.slope[np.isfinite(self.slope)]
        return float(np.median(seen)) if len(seen) else 0.0

    @property
    def support(self) -> Array:
        """Covered part of what is visible, per circle; 0 where nothing is."""
        return np.divide(
            self.covered, self.visible, out=np.zeros(CIRCLES), where=self.visible > 0.02
        )


def measure_marks(
    picture: Picture,
    view: Array,
    rig: Array,
    *,
    reach: float,
    spacing: float = 6.0,
    lines: bool = True,
    edge: PaintEdge = HALF_WAY,
) -> Evidence:
    """Measure the circles, and the lines if asked, near where the camera puts them.

    Parameters
    ----------
    picture : Picture
    view, rig : ndarray
        Camera as in `curlshot.vision.optics.pose` and `curlshot.vision.optics.rig`.
    reach : float
        Half length of the normals, px.
    spacing : float
        Distance of neighbouring normals on a circle, px.
    lines : bool
        Whether lines are measured.
    edge : PaintEdge
        Where the circles are in the profiles across them.
    """
    h, w = picture.shape[:2]
    normals = lay_out(view, rig, (w, h), reach=reach, spacing=spacing, lines=lines)
    return measure_along([picture], normals, normals.standing[None], edge=edge)[0]


def measure_along(
    pictures: Sequence[Picture],
    normals: Normals,
    standing: Array,
    *,
    least_sd: float = EDGE_SD,
    palette: Array | None = None,
    edge: PaintEdge = HALF_WAY,
    levels: Array | None = None,
) -> list[Evidence]:
    """Measure circles and lines in several pictures along the same normals.

    Parameters
    ----------
    pictures : sequence of Picture
    normals : Normals
    standing : ndarray, shape (pictures, 2, 2, n)
        As `Normals.standing`, in each picture.
    least_sd : float
        Least standard deviation of a mark, px.
    palette : ndarray, shape (9, 2, 3), optional
        Colours on either side of each kind of edge in the frames before; NaN where not known.
    edge : PaintEdge
        Where the circles are in the profiles across them.
    levels : ndarray, shape (n,), optional
        Levels to be added to those of `edge` at which profiles are crossed: motion blur.
    """
    points = standing[:, 0]
    places, wide = _places(normals), normals.wide
    colours = profiles(pictures, normals, points)
    if palette is None:
        palette = np.full((FIXED, 2, colours.shape[1]), np.nan)
    edges = _edges(colours[..., :wide], normals, palette, edge, levels)
    within = points[:, 0, wide::BLOCK] > OUTSIDE
    stripes, shown = find_stripes(colours[..., wide:], places.blocks, within)
    offset, good = np.append(edges.offset, stripes, -1), np.append(edges.good, shown, -1)
    good, sd = _inlying(places, offset, good, least_sd)
    covered = np.zeros((len(good), CIRCLES))
    for kind in range(CIRCLES):
        if kind in places.kinds:
            covered[:, kind] = normals.visible[kind] * good[:, places.kinds[kind]].mean(1)
    middles = standing[..., wide:].reshape(*standing.shape[:3], -1, BLOCK).mean(4)
    place, normal = np.moveaxis(np.append(standing[..., :wide], middles, axis=3), 1, 0)
    pixel = place + places.normal * offset[:, None]
    return [
        Evidence(
            Marks(places.line, places.along, pixel[k].T, normal[k].T, sd[k]).pick(good[k]),
            normals.visible, covered[k], edges.palette[k], edges.rim[k], edges.crossing[k],
            edges.slope[k], edges.step,
        )
        for k in range(len(pictures))
    ]  # fmt: skip


@dataclass(frozen=True)
class _Edges:
    """Edges of circles and wide lines in some pictures, n normals across them.

    Attributes
    ----------
    offset, good : ndarray, shape (pictures, n)
        How far along its normal each lies, px, and whether the profile shows it.
    palette, rim, crossing, slope, step
        As in `Evidence`, of each picture.
    """

    offset: Array
    good: Flags
    palette: Array
    rim: Profiles
    crossing: Array
    slope: Array
    step: float


def _edges(
    colours: Profiles, normals: Normals, palette: Array, edge: PaintEdge, levels: Array | None
) -> _Edges:
    """Find edges in profiles across them, (pictures, 3, SAMPLES, n); see `measure_along`."""
    count = colours.shape[-1]
    kinds = {kind: part for kind, part in normals.kinds.items() if kind not in THIN}
    rim = kinds.get(TWELVE, slice(0))
    value, good, found = steps(colours, normals, palette)
    value[..., rim] -= np.float32(edge.level)
    for kind in range(CIRCLES):
        value[..., kinds.get(kind, slice(0))] -= np.float32(edge.light[kind])
    if levels is not None:
        value -= levels[:count].astype(np.float32)
    rising, inset = value.copy(), np.zeros(good.shape)
    for k, one in enumerate(colours):
        for part in outlines(one, kinds, value[k], good[k], found[k]):
            rising[k][:, part] = summed(value[k][:, part])
            inset[k, part] = edge.within * normals.magnified[part]
    sample, rise, crossed = crossings(rising)
    step = 2 * normals.wanted / (SAMPLES - 1)
    slope = rise[..., rim] / step
    sample -= inset / step
    sample[..., rim] -= edge.beyond(slope) / step
    off = sample / (SAMPLES // 2) - 1
    reach = normals.reach[:count]
    good &= crossed & ~((reach < normals.wanted) & (np.abs(off) > CLEAR))
    crossing, slope = (np.where(good[:, rim], v, np.nan) for v in (sample[:, rim], slope))
    profile = value[..., rim] + np.float32(edge.level + edge.light[TWELVE])
    return _Edges(off * reach, good, found, profile, crossing, slope, step)


def _inlying(places: _Places, offset: Array, shown: Flags, least_sd: float) -> tuple[Flags, Array]:
    """Leave out outliers on straight lines; the standard deviation of each mark by its scatter.

    Parameters
    ----------
    offset, shown : ndarray, shape (pictures, n)
        How far along its normal each place has its edge, px, and whether there is one.

    Returns
    -------
    good, sd : ndarray, shape (pictures, n)
    """
    good, sd = shown.copy(), np.full(shown.shape, least_sd)
    for kind in range(CIRCLES):
        if kind in places.kinds:
            part = places.kinds[kind]
            sd[:, part] = np.maximum(_scatter(offset[:, part], shown[:, part]), least_sd)[:, None]
    if len(places.least):
        index, real = places.runs.index, places.runs.real
        on_line = shown[:, index] & real
        on_line &= (on_line.sum(2) >= places.least)[..., None]
        left, spread = smooth(places.curves, offset[:, index], on_line, least_sd)
        good[:, index[real]] = left[:, real]
        sd[:, index] = spread[..., None]
    return good, sd


def profiles(pictures: Sequence[Picture], normals: Normals, points: Array) -> Profiles:
    """Colours along the normals at these places in pictures.

    Parameters
    ----------
    pictures : sequence of Picture
    normals : Normals
    points : ndarray, shape (pictures, 2, n)
        Where they are in each, px.

    Returns
    -------
    ndarray, shape (pictures, 3, SAMPLES, n)
    """
    found = np.empty((len(pictures), 3, SAMPLES, points.shape[-1]), np.float32)
    if normals.kinds:
        places = points.astype(np.float32)[:, :, None] + normals.samples
        for k, picture in enumerate(pictures):
            found[k] = channels_at(picture, *places[k])
    return found


@dataclass(frozen=True, eq=False)
class _Places:
    """Where marks may be: normals across wide lines and circles, and blocks of thin lines.

    Attributes
    ----------
    kinds : dict of int to slice
        Which of the places lie on each kind of line.
    line, along, normal : ndarray, shapes (n,), (n,) and (2, n)
        As in `curlshot.vision.optics.paint.Marks`.
    blocks : Blocks
        Those of thin lines.
    runs, curves : Runs, Curves
        The places along each straight line, and curves through them.
    least : ndarray, shape (lines,)
        How many of them must show it.
    """

    kinds: dict[int, slice]
    line: Index
    along: Array
    normal: Array
    blocks: Blocks
    runs: Runs
    curves: Curves
    least: Array


@lru_cache(maxsize=2)
def _places(normals: Normals) -> _Places:
    wide, blocks = normals.wide, Blocks.of(normals)
    kinds = {kind: part for kind, part in normals.kinds.items() if kind not in THIN}
    kinds |= {
        kind: slice(wide + part.start, wide + part.stop) for kind, part in blocks.kinds.items()
    }
    along = np.append(normals.along[:wide], blocks.along)
    straight = {kind: part for kind, part in kinds.items() if kind >= CIRCLES}
    runs = Runs.of(list(straight.values()))
    return _Places(
        kinds,
        np.repeat(list(kinds), [part.stop - part.start for part in kinds.values()]),
        along,
        np.append(normals.normal[:, :wide], blocks.normal, axis=1),
        blocks,
        runs,
        Curves.along(along[runs.index]),
        np.array(
            [
                0.0 if kind in THIN else max(LEAST_ON_LINE, LEAST_SHARE * (part.stop - part.start))
                for kind, part in straight.items()
            ]
        ),
    )


def _mean_profile(value: Profiles, middle: Array) -> Array:
    """Average profiles about their middles; NaN where fewer than half of them reach."""
    at = middle[:, None] + np.arange(SAMPLES) - SAMPLES // 2
    low = np.floor(at).astype(np.int64)
    known = (low >= 0) & (low < SAMPLES - 1)
    low = np.clip(low, 0, SAMPLES - 2)
    row = np.arange(len(value))[:, None]
    between = value[row, low] + (at - low) * (value[row, low + 1] - value[row, low])
    count = known.sum(0)
    enough = count > max(len(value) // 2, 5)
    total = (between * known).sum(0)
    return np.asarray(np.divide(total, count, out=np.full(SAMPLES, np.nan), where=enough))


def _scatter(offset: Array, shown: Flags) -> Array:
    """Tell the standard deviation of single offsets in each row from neighbours' differences."""
    both = shown[:, 1:] & shown[:, :-1]
    steps = np.sort(np.where(both, np.abs(np.diff(offset)), np.inf), axis=1)
    count = both.sum(1)
    middle = np.take_along_axis(steps, count[:, None] // 2, 1)[:, 0]
    return np.where(count < LEAST_PAIRS, EDGE_SD, 1.05 * middle)
