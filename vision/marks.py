"""Edges of the painted circles and lines, measured along their normals at sub-pixel precision.

Nothing is known about colours. Beside each line the colour on either side is learned: given from
the frames before, else the median along it; a normal counts where both sides look like that, and
the edge is where the profile crosses half way. Thin lines are left to `vision.stripes`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.normals import SAMPLES, THIN, Normals, Profiles, lay_out, profiles
from vision.paint import CIRCLES, FIXED, TWELVE, Marks
from vision.picture import Picture
from vision.runs import Runs, smooth
from vision.stripes import find_stripes

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

MIN_CONTRAST = 10.0
"""Least difference of the two sides of an edge, grey levels."""

EDGE_SD = 0.45
"""Standard deviation of an edge point with the errors of paint that neighbours share, px."""

NOISE_SD = 0.1
"""Least standard deviation of an edge point by itself, px."""

_TO_CHROMA = np.array([[0.114, 0.587, 0.299], [0.5, -0.331, -0.169], [-0.081, -0.419, 0.5]])
_WORTH = np.array([1.0, 0.25, 0.25])

SHARPNESS = np.asarray(_TO_CHROMA.T * _WORTH @ _TO_CHROMA, np.float32)
"""How much colours (blue, green, red) tell of where an edge is: most cameras and films keep what
is not brightness (ITU-R BT.601) at half the resolution."""

LEAST_ON_LINE, LEAST_SHARE = 8, 0.3
"""Edge points that the side of the sheet or a wide line must have, and the share of normals."""

_END = SAMPLES // 4
_ENDS = np.zeros((2, SAMPLES), np.float32)
_ENDS[0, :_END] = _ENDS[1, -_END:] = 1 / _END


@dataclass(frozen=True)
class Evidence:
    """What a frame says about the circles.

    Attributes
    ----------
    marks : Marks
    visible : ndarray, shape (3,)
        Fraction of each circle inside the picture.
    covered : ndarray, shape (3,)
        Fraction of each circle that has an edge of the circle's own two colours.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge; NaN where none was made out.
    rim : ndarray, shape (n, 33)
        Profiles across the 12-ft edge, from ice (−0.5) to paint (0.5).
    crossing : ndarray, shape (n,)
        Samples at which the marks on it are.
    step : float
        Distance of the samples, px.
    """

    marks: Marks
    visible: Array
    covered: Array
    palette: Array
    rim: Profiles
    crossing: Array
    step: float

    @property
    def profile(self) -> Array:
        """Mean profile across the 12-ft edge about the marks, shape (33,); NaN where unknown."""
        return _mean_profile(self.rim, self.crossing)

    @property
    def support(self) -> Array:
        """Covered part of what is visible, per circle; 0 where nothing is."""
        return np.divide(
            self.covered, self.visible, out=np.zeros(CIRCLES), where=self.visible > 0.02
        )


def measure(
    picture: Picture,
    view: Array,
    rig: Array,
    *,
    reach: float,
    spacing: float = 6.0,
    most: int = 360,
    least_sd: float = EDGE_SD,
    palette: Array | None = None,
    lines: bool = True,
    level: float = 0.0,
) -> Evidence:
    """Measure the circles, and the lines if asked, near where the camera puts them.

    Parameters
    ----------
    picture : Picture
    view, rig : ndarray
        Camera as in `vision.pose` and `vision.rig`.
    reach : float
        Half length of the normals, px.
    spacing, most : float, int
        Distance of neighbouring normals on a circle, px, and how many of them at most.
    least_sd : float
        Least standard deviation of a mark, px.
    palette : ndarray, shape (9, 2, 3), optional
        Colours of the edges in the frames before; NaN where not known.
    lines : bool
        Whether lines are measured.
    level : float
        Where the 12-ft edge is between ice (−0.5) and paint (0.5), as `vision.outline` tells.
    """
    h, w = picture.shape[:2]
    normals = lay_out(view, rig, (w, h), reach=reach, spacing=spacing, most=most, lines=lines)
    return measure_along(picture, normals, least_sd=least_sd, palette=palette, level=level)


def measure_along(
    picture: Picture,
    normals: Normals,
    *,
    least_sd: float = EDGE_SD,
    palette: Array | None = None,
    level: float = 0.0,
) -> Evidence:
    """Measure circles and lines along given normals; see `measure`."""
    colours = profiles(picture, normals)
    wide = {kind: part for kind, part in normals.kinds.items() if kind not in THIN}
    count = max((part.stop for part in wide.values()), default=0)
    if palette is None:
        palette = np.full((FIXED, 2, colours.shape[2]), np.nan)
    value, good, found = _steps(colours[:count], wide, palette)
    shift = np.zeros(count)
    shift[wide.get(TWELVE, slice(0))] = level
    sample, crossed = _crossings(value - shift.astype(np.float32)[:, None])
    good &= crossed
    rim = np.flatnonzero(good[wide.get(TWELVE, slice(0))])
    stripes = find_stripes(colours, normals)
    # Both together: edges and, behind them, blocks of thin lines.
    kinds = wide | {
        kind: slice(part.start + count, part.stop + count) for kind, part in stripes.kinds.items()
    }
    along = np.append(normals.along[:count], stripes.along)
    point = np.concatenate([normals.point[:count], stripes.point])
    normal = np.concatenate([normals.normal[:count], stripes.normal])
    offset = np.append((sample / (SAMPLES // 2) - 1) * normals.reach[:count], stripes.offset)
    good = np.append(good, stripes.good)
    covered = np.zeros(CIRCLES)
    sd = np.full(len(good), least_sd)
    straight = []
    for kind, part in kinds.items():
        shown = good[part]
        if kind < CIRCLES:
            covered[kind] = normals.visible[kind] * shown.mean()
            sd[part] = max(_scatter(offset[part][shown]), least_sd)
        elif kind in THIN or shown.sum() >= max(LEAST_ON_LINE, LEAST_SHARE * len(shown)):
            straight.append(part)
        else:
            good[part] = False
    if straight:
        runs = Runs.of(straight)
        shown = good[runs.index] & runs.real
        left, spread = smooth(along[runs.index], offset[runs.index], shown, least_sd)
        good[runs.index[runs.real]] = left[runs.real]
        sd[runs.index] = spread[:, None]
    line = np.repeat(list(kinds), [part.stop - part.start for part in kinds.values()])
    marks = Marks(line, along, point + normal * offset[:, None], normal, sd).pick(good)
    step = 2 * float(normals.reach[0]) / (SAMPLES - 1) if count else 0.0
    return Evidence(marks, normals.visible, covered, found, value[rim], sample[rim], step)


def _steps(
    profile: Profiles, kinds: dict[int, slice], known: Array
) -> tuple[Profiles, Flags, Array]:
    """Put profiles on the scale from the one side (−0.5) to the other (0.5).

    Returns
    -------
    value : ndarray, shape (n, SAMPLES)
    good : ndarray of bool, shape (n,)
        Whether the profile shows the edge.
    palette : ndarray, shape (9, 2, 3)
        Colours on either side of each kind of edge.
    """
    ends = _ENDS @ profile
    sides = np.empty_like(ends)
    for kind, part in kinds.items():
        learned = np.isfinite(known[kind, 0, 0])
        sides[part] = known[kind] if learned else np.sort(ends[part], axis=0)[len(ends[part]) // 2]
    difference = sides[:, 1] - sides[:, 0]
    square = (difference**2).sum(1)
    # Each side looks like the line's own two colours; light may vary, hue may not.
    tolerance = np.maximum(0.25 * square, 12.0**2)
    good = (((ends - sides) ** 2).sum(2) < tolerance[:, None]).all(1)
    axis = difference @ SHARPNESS
    axis /= np.maximum((axis * difference).sum(1), 1.0)[:, None]
    height = (ends @ axis[..., None])[..., 0]
    strength = height[:, 1] - height[:, 0]
    good &= (strength > 0.5) & (strength < 1.6) & (square > MIN_CONTRAST**2)
    value = (profile @ axis[..., None])[..., 0] - height.mean(1)[:, None]
    palette = np.full(known.shape, np.nan)
    for kind, part in kinds.items():
        shown = good[part]
        if shown.any():
            total = shown.astype(np.float32) @ ends[part].reshape(len(shown), -1)
            palette[kind] = (total / shown.sum()).reshape(palette.shape[1:])
    return value, good, palette


def _crossings(value: Profiles) -> tuple[Array, Flags]:
    """Find where profiles rise through 0, in samples, and whether they do."""
    rising = (value[:, 1:-2] < 0) & (value[:, 2:-1] >= 0)
    # Of several crossings the steepest is the edge, the others are noise or print.
    slope = np.where(rising, value[:, 3:] - value[:, :-3], 0.0)
    best = slope.argmax(1) + 1
    row = np.arange(len(value))
    good = slope[row, best - 1] > 0
    low, high = value[row, best], value[row, best + 1]
    return best + (low / np.where(good, low - high, 1.0)).astype(np.float64), good


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


def _scatter(offset: Array) -> float:
    """Tell the standard deviation of single offsets from neighbours' differences; robust."""
    if len(offset) < 4:
        return EDGE_SD
    steps = np.sort(np.abs(np.diff(offset)))
    return 1.05 * float(steps[len(steps) // 2])
