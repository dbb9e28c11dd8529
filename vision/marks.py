"""Edges of the painted circles and lines, measured along their normals at sub-pixel precision.

Nothing is known about colours. On each circle the colour on either side is learned from the
frame itself (the median around the circle); a normal counts where both sides look like that, and
the edge is where the profile crosses half way. A thin line is where the profile leaves the mean
of its two sides, in the direction of colour in which the whole line does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import SHEET
from vision.pose import (
    CENTRE_LINE,
    CIRCLES,
    LEFT,
    RIGHT,
    TEE_LINE,
    Marks,
    ice_points,
    joined,
    project,
)

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

STEP = 0.5
"""Spacing of samples along a normal, px."""

MIN_CONTRAST = 10.0
"""Least difference of the two sides of an edge, grey levels."""

EDGE_SD = 0.45
"""Standard deviation of one edge point, px; neighbours share errors of paint and outline."""

LINE_SD = 0.5

STRONG = 15.0
"""Grey levels beyond which a stronger contrast says no more about a thin line."""

LINE_REACH = 0.05
"""Half width looked at across a thin line, m: some are painted as two stripes 3 cm apart."""


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
    """

    marks: Marks
    visible: Array
    covered: Array

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
    spacing : float
        Distance of neighbouring normals on a circle, px.
    """
    parts: list[Marks] = []
    visible, covered = np.zeros(CIRCLES), np.zeros(CIRCLES)
    h, w = image.shape[:2]
    for k in range(CIRCLES):
        rough = np.linspace(-np.pi, np.pi, 73)
        place = _project(k, rough, view, rig, (w, h))
        length = float(np.nansum(np.hypot(*np.diff(place, axis=0).T)))
        count = int(np.clip(length / spacing, 24, 360))
        angle = np.linspace(-np.pi, np.pi, count, endpoint=False)
        seen = _normals(k, angle, view, rig, (w, h), reach)
        visible[k] = len(seen.along) / count
        if len(seen.along) < 8:
            continue
        offset, good = _steps(_profiles(image, seen, reach), reach)
        covered[k] = good.sum() / count
        parts.append(_marks(k, seen, offset, good, EDGE_SD))
    if lines:
        parts.extend(_line_marks(image, view, rig, reach))
    return Evidence(joined(parts), visible, covered)


@dataclass(frozen=True)
class _Normals:
    along: Array
    point: Array
    normal: Array


def _project(line: int, along: Array, view: Array, rig: Array, size: tuple[int, int]) -> Array:
    return project(ice_points(np.full(len(along), line), along, rig), view, rig, size)


def _normals(
    line: int, along: Array, view: Array, rig: Array, size: tuple[int, int], reach: float
) -> _Normals:
    """Where a line's points fall inside the picture, and the picture's normals there."""
    point = _project(line, along, view, rig, size)
    ahead = _project(line, along + 1e-3, view, rig, size) - point
    with np.errstate(invalid="ignore", divide="ignore"):
        tangent = ahead / np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)
    inside = np.ones(len(along), bool)
    for end in (point - reach * normal, point + reach * normal):
        with np.errstate(invalid="ignore"):
            inside &= ((end >= 0) & (end <= np.array(size) - 1)).all(-1)
    return _Normals(along[inside], point[inside], normal[inside])


def _profiles(image: Image, seen: _Normals, reach: float) -> Array:
    """Colours along the normals, shape (n, m, 3); m odd, the middle at the point itself."""
    s = np.arange(-round(reach / STEP), round(reach / STEP) + 1) * STEP
    x = seen.point[:, :1] + seen.normal[:, :1] * s
    y = seen.point[:, 1:] + seen.normal[:, 1:] * s
    return cv2.remap(
        image.astype(np.float32) if image.dtype != np.uint8 else image,
        x.astype(np.float32),
        y.astype(np.float32),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_REPLICATE,
    ).astype(np.float64)


def _steps(profile: Array, reach: float) -> tuple[Array, NDArray[np.bool_]]:
    """Offsets (px, along the normal) at which the profiles cross from one side to the other."""
    n, m, _ = profile.shape
    third = m // 3
    first, last = profile[:, :third].mean(1), profile[:, -third:].mean(1)
    one, two = np.median(first, axis=0), np.median(last, axis=0)
    axis = two - one
    contrast = float(np.linalg.norm(axis))
    if contrast < MIN_CONTRAST:
        return np.zeros(n), np.zeros(n, bool)
    axis = axis / contrast
    strength = (last - first) @ axis
    # Each side looks like the circle's own two colours; light may vary, hue may not.
    tolerance = max(0.5 * contrast, 12.0)
    alike = (np.linalg.norm(first - one, axis=1) < tolerance) & (
        np.linalg.norm(last - two, axis=1) < tolerance
    )
    alike &= (strength > 0.5 * contrast) & (strength < 1.6 * contrast)
    value = profile @ axis
    level = (0.5 * (first + last) @ axis)[:, None]
    below = value < level
    crossing = below[:, :-1] & ~below[:, 1:]
    s = (np.arange(m) - (m - 1) / 2) * STEP
    with np.errstate(invalid="ignore", divide="ignore"):
        part = (level - value[:, :-1]) / (value[:, 1:] - value[:, :-1])
    where = s[:-1] + STEP * np.where(crossing, part, 0)
    # Of several crossings the steepest is the edge, the others are noise or print.
    smooth = value[:, 2:] - value[:, :-2] if m > 4 else value[:, 1:] - value[:, :-1]
    slope = np.pad(smooth, ((0, 0), (1, 1)), mode="edge")[:, :-1]
    best = np.where(crossing, slope, -np.inf).argmax(1)
    row = np.arange(n)
    return where[row, best], alike & crossing[row, best] & (slope[row, best] > 0)


def _line_marks(image: Image, view: Array, rig: Array, reach: float) -> list[Marks]:
    h, w = image.shape[:2]
    found = []
    for line, lo, hi in (
        (CENTRE_LINE, -4.0, SHEET.hog_line + 3),
        (TEE_LINE, -SHEET.half_width_min, SHEET.half_width_min),
    ):
        along = np.arange(lo, hi, 0.03)
        seen = _normals(line, along, view, rig, (w, h), 0.0)
        if len(seen.along) < 24:
            continue
        spread = float(np.median(np.hypot(*np.diff(seen.point, axis=0).T))) / 0.03
        wide = max(reach, LINE_REACH * spread)
        seen = _normals(line, along, view, rig, (w, h), wide)
        if len(seen.along) < 24:
            continue
        marks = _ridges(line, seen, _profiles(image, seen, wide), group=8)
        if marks is not None:
            found.append(marks)
    for line in (LEFT, RIGHT):
        seen = _normals(line, np.arange(-4.0, SHEET.hog_line + 3, 0.1), view, rig, (w, h), reach)
        if len(seen.along) < 15:
            continue
        offset, good = _steps(_profiles(image, seen, reach), reach)
        if good.sum() > max(12, 0.3 * len(good)):
            found.append(_marks(line, seen, offset, good, EDGE_SD))
    return [_straight(marks) for marks in found]


def _straight(marks: Marks) -> Marks:
    """Drop what lies off a smooth curve through a line's marks; what is ragged counts less."""
    offset = (marks.pixel * marks.normal.mean(0)).sum(-1)
    s = marks.along - marks.along.mean()
    keep = np.ones(len(s), bool)
    spread = 1.0
    for _ in range(3):
        curve = np.polynomial.Polynomial.fit(s[keep], offset[keep], 2 if keep.sum() > 5 else 1)
        away = np.abs(offset - curve(s))
        spread = max(1.5 * float(np.median(away[keep])), LINE_SD)
        keep = away < 2.5 * spread
        if keep.sum() < 3:
            break
    kept = marks.pick(keep)
    return replace(kept, sd=np.full(len(kept), spread))


def _ridges(line: int, seen: _Normals, profile: Array, group: int) -> Marks | None:
    """Measure a thin line, `group` neighbouring normals together; None where none is seen."""
    m = profile.shape[1]
    quarter = m // 5
    first, last = profile[:, :quarter].mean(1), profile[:, -quarter:].mean(1)
    s = (np.arange(m) - (m - 1) / 2) * STEP
    slant = (last - first)[:, None, :] * (s / (s[-1] - s[0]) / 0.8)[None, :, None]
    deviation = profile - 0.5 * (first + last)[:, None, :] - slant
    calm = np.linalg.norm(last - first, axis=1) < 12
    calm &= np.abs(deviation).max((1, 2)) < 80
    at = np.flatnonzero(calm)
    count = len(at) // group
    if count < 3:
        return None
    rows = at[: count * group].reshape(count, group)
    # Darker than the ice, perhaps lighter than the paint: only the size of the deviation counts.
    value = np.linalg.norm(deviation[rows].mean(1), axis=-1)
    along = seen.along[rows].mean(1)
    share = (along - along[0]) / (along[-1] - along[0])
    # The straight path across the profiles along which they deviate most.
    ends = np.arange(quarter, m - quarter, 2)
    one, two = (g.ravel() for g in np.meshgrid(ends, ends))
    path = np.round(one[:, None] + (two - one)[:, None] * share).astype(np.int64)
    strength = np.minimum(value, STRONG)[np.arange(count), path].mean(1)
    best = int(strength.argmax())
    if strength[best] < max(2.0, 2 * float(np.percentile(strength, 25))):
        return None
    window = np.arange(-6, 7)
    near = value[np.arange(count)[:, None], np.clip(path[best][:, None] + window, 0, m - 1)]
    top = 3 + near[:, 3:-3].argmax(1)
    around = top[:, None] + np.arange(-3, 4)
    height = near[np.arange(count), top]
    weight = np.clip(near[np.arange(count)[:, None], around] - 0.4 * height[:, None], 0, None)
    total = weight.sum(1)
    index = (weight * (around - 6)).sum(1) / np.where(total > 0, total, 1.0)
    offset = STEP * (path[best] + index - (m - 1) / 2)
    good = (height > 0.4 * strength[best]) & (total > 0)
    middle = rows[:, group // 2]
    picked = _Normals(seen.along[middle], seen.point[middle], seen.normal[middle])
    return _marks(line, picked, offset, good, LINE_SD) if good.sum() >= 3 else None


def _marks(line: int, seen: _Normals, offset: Array, good: NDArray[np.bool_], sd: float) -> Marks:
    pixel = seen.point[good] + seen.normal[good] * offset[good, None]
    count = int(good.sum())
    return Marks(
        np.full(count, line), seen.along[good], pixel, seen.normal[good], np.full(count, sd)
    )
