"""Edges of the painted circles and lines, measured along their normals at sub-pixel precision.

Nothing is known about colours. Beside each line the colour on either side is learned: given from
the frames before, else the median along it; a normal counts where both sides look like that, and
the edge is where the profile crosses half way. A thin line is where the profile leaves the mean
of its two sides, in whatever direction of colour.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.normals import BLOCK, SAMPLES, THIN, Normals, Profiles, lay_out, profiles
from vision.pose import CIRCLES, FIXED, TWELVE, Marks, joined

Array = NDArray[np.float64]
Image = NDArray[np.uint8]
Flags = NDArray[np.bool_]

MIN_CONTRAST = 10.0
"""Least difference of the two sides of an edge, grey levels."""

EDGE_SD = 0.45
"""Standard deviation of an edge point with the errors of paint that neighbours share, px."""

NOISE_SD = 0.1
"""Least standard deviation of an edge point by itself, px."""

FAINT = 1.5
"""Grey levels that a thin line must stand out by to count half."""

CLEAR = 0.6
"""How clear a thin line must be all along, 1 for strong everywhere."""

STRIPES_SD = 0.018
"""Width of the bell that a thin line is smoothed with, m: two stripes become one."""

CALM, LOUD = 12.0, 80.0
"""Where the sides of a thin line differ by more, or it stands out by more, it is something else,
grey levels."""

_TO_CHROMA = np.array([[0.114, 0.587, 0.299], [0.5, -0.331, -0.169], [-0.081, -0.419, 0.5]])
_WORTH = np.array([1.0, 0.25, 0.25])

SHARPNESS = np.asarray(_TO_CHROMA.T * _WORTH @ _TO_CHROMA, np.float32)
"""How much colours (blue, green, red) tell of where an edge is: most cameras and films keep what
is not brightness (ITU-R BT.601) at half the resolution."""

_SLANT = ((np.arange(SAMPLES, dtype=np.float32) - SAMPLES // 2) / (SAMPLES - SAMPLES // 5))[:, None]


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
    profile : ndarray, shape (33,)
        Mean profile across the 12-ft edge, from ice (−0.5) to paint (0.5), about the marks.
    step : float
        Distance of its samples, px.
    """

    marks: Marks
    visible: Array
    covered: Array
    palette: Array
    profile: Array
    step: float

    @property
    def support(self) -> Array:
        """Covered part of what is visible, per circle; 0 where nothing is."""
        return np.divide(
            self.covered, self.visible, out=np.zeros(CIRCLES), where=self.visible > 0.02
        )


def measure(
    image: Image,
    view: Array,
    rig: Array,
    *,
    reach: float,
    spacing: float = 6.0,
    most: int = 360,
    least_sd: float = EDGE_SD,
    palette: Array | None = None,
    level: float = 0.0,
    lines: bool = True,
) -> Evidence:
    """Measure the circles, and the lines if asked, near where the camera puts them.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)
    view, rig : ndarray
        Camera as in `vision.pose`.
    reach : float
        Half length of the normals, px.
    spacing, most : float, int
        Distance of neighbouring normals on a circle, px, and how many of them at most.
    least_sd : float
        Least standard deviation of a mark, px.
    palette : ndarray, shape (9, 2, 3), optional
        Colours of the edges in the frames before; NaN where not known.
    level : float
        Where the 12-ft edge is between ice (−0.5) and paint (0.5), as `vision.outline` tells.
    """
    h, w = image.shape[:2]
    normals = lay_out(view, rig, (w, h), reach=reach, spacing=spacing, most=most, lines=lines)
    found, mean = np.full((FIXED, 2, 3), np.nan), np.full(SAMPLES, np.nan)
    covered = np.zeros(CIRCLES)
    parts: list[Marks] = []
    if normals.kinds:
        colours = profiles(image, normals)
        wide = {kind: part for kind, part in normals.kinds.items() if kind not in THIN}
        known = found if palette is None else palette
        values, shown, found = _steps(
            colours[: sum(p.stop - p.start for p in wide.values())], wide, known
        )
        rim = wide.get(TWELVE, slice(0))
        values[rim] -= level
        samples, crossed = _crossings(values)
        shown &= crossed
        mean = _mean_profile(values[rim][shown[rim]], samples[rim][shown[rim]]) + level
        offsets = samples / (SAMPLES // 2) - 1
        for kind, part in wide.items():
            offset, good = offsets[part] * normals.reach[part], shown[part]
            if kind < CIRCLES:
                covered[kind] = normals.visible[kind] * good.mean()
                sd = max(_scatter(offset[good]), least_sd)
            elif good.sum() >= max(8, 0.3 * len(good)):
                good, sd = _straight(normals.along[part], offset, good, least_sd)
            else:
                continue
            pixel = normals.point[part] + normals.normal[part] * offset[:, None]
            parts.append(_marks(kind, normals.along[part], pixel, normals.normal[part], good, sd))
        for kind in THIN:
            if kind in normals.kinds:
                part = normals.kinds[kind]
                parts.extend(_thin_line(kind, normals, part, colours[part], least_sd))
    step = 2 * reach / (SAMPLES - 1)
    return Evidence(joined(parts), normals.visible, covered, found, mean, step)


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
    third = SAMPLES // 3
    ends = np.stack([profile[:, :third].mean(1), profile[:, -third:].mean(1)], axis=1)
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
    height = np.einsum("nsc,nc->ns", ends, axis)
    strength = height[:, 1] - height[:, 0]
    good &= (strength > 0.5) & (strength < 1.6) & (square > MIN_CONTRAST**2)
    value = np.einsum("nmc,nc->nm", profile, axis) - height.mean(1)[:, None]
    palette = np.full((FIXED, 2, 3), np.nan)
    for kind, part in kinds.items():
        if good[part].any():
            palette[kind] = ends[part][good[part]].mean(0)
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


def _straight(along: Array, offset: Array, good: Flags, least_sd: float) -> tuple[Flags, float]:
    """Leave out what lies off a smooth curve through a line's offsets; what is ragged counts less.

    Returns which are left and their standard deviation.
    """
    s = (along - along.mean()) / np.ptp(along)
    terms = np.stack([np.ones(len(s)), s, s * s])
    keep, spread = good, least_sd
    for _ in range(2):
        count = min(3, max(int(keep.sum()) // 2, 1))
        on = terms[:count, keep]
        curve = np.linalg.solve(on @ on.T + 1e-9 * np.eye(count), on @ offset[keep]) @ terms[:count]
        away = np.abs(offset - curve)
        spread = max(1.5 * float(np.sort(away[keep])[keep.sum() // 2]), least_sd)
        keep = good & (away < 2.5 * spread)
        if keep.sum() < 3:
            break
    return keep, spread


def _thin_line(
    kind: int, normals: Normals, part: slice, profile: Profiles, least_sd: float
) -> list[Marks]:
    """Measure a thin line, blocks of neighbouring normals together; nothing if none is seen."""
    fifth = SAMPLES // 5
    mean = profile.reshape(-1, BLOCK, SAMPLES, 3).mean(1)
    first, last = mean[:, :fifth].mean(1), mean[:, -fifth:].mean(1)
    mean -= 0.5 * (first + last)[:, None] + (last - first)[:, None] * _SLANT
    use = ((last - first) ** 2).sum(1) < CALM**2
    use &= np.abs(mean).max((1, 2)) < LOUD
    if use.sum() < 3:
        return []
    along, point, normal = (
        whole[part].reshape(-1, BLOCK, *whole.shape[1:])[use].mean(1)
        for whole in (normals.along, normals.point, normals.normal)
    )
    step = 2 * float(normals.reach[part][0]) / (SAMPLES - 1)
    # Darker than the ice, perhaps lighter than the paint: only the size of the deviation counts.
    smooth = _bell(STRIPES_SD * _scale(along, point) / step) @ mean[use]
    value = np.sqrt((smooth**2).sum(2))
    share = (along - along[0]) / (along[-1] - along[0])
    # The straight path across the profiles along which they deviate most.
    ends = np.arange(fifth, SAMPLES - fifth, 2)
    path = np.round(ends[:, None, None] + (ends[:, None] - ends[:, None, None]) * share)
    path = path.reshape(-1, len(share)).astype(np.int64)
    row = np.arange(len(value))
    clear = value / (value.max(1, keepdims=True) + FAINT)
    strength = clear[row, path].mean(1)
    best = path[int(strength.argmax())]
    highest = float(strength.max())
    if highest < CLEAR:
        return []
    near = value[row[:, None], best[:, None] + np.arange(-2, 3)]
    top = near[:, 1:-1].argmax(1) + 1
    low, height, high = near[row, top - 1], near[row, top], near[row, top + 1]
    bend = np.maximum(2 * height - low - high, 1e-9)
    offset = step * (best + top - 2 + 0.5 * (high - low) / bend - (SAMPLES - 1) / 2)
    good = (height > 0.4 * highest) & (height >= low) & (height >= high)
    if good.sum() < 3:
        return []
    good, sd = _straight(along, offset, good, least_sd)
    pixel = point + normal * offset[:, None]
    return [_marks(kind, along, pixel, normal, good, sd)]


def _scale(along: Array, point: Array) -> float:
    """Pixels per metre along a line."""
    return float(np.hypot(*(point[-1] - point[0])) / (along[-1] - along[0]))


def _bell(sd: float) -> Profiles:
    """Matrix that smooths profiles by a bell of `sd` samples, (SAMPLES, SAMPLES)."""
    away = np.arange(SAMPLES)[:, None] - np.arange(SAMPLES)
    weight = np.exp(-0.5 * (away / max(sd, 1.0)) ** 2)
    return np.asarray(weight / weight.sum(1, keepdims=True), np.float32)


def _marks(kind: int, along: Array, pixel: Array, normal: Array, good: Flags, sd: float) -> Marks:
    count = int(good.sum())
    return Marks(np.full(count, kind), along[good], pixel[good], normal[good], np.full(count, sd))
