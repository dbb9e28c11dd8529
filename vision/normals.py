"""Where the painted lines may be measured in a picture: places on them, and their normals."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import SHEET
from vision.pose import (
    BACK_LINE,
    CENTRE_LINE,
    CIRCLES,
    HOG_LINE,
    LEFT,
    RIGHT,
    TEE_LINE,
    ice_points,
    project,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Image = NDArray[np.uint8]
Profiles = NDArray[np.float32]

THIN = (CENTRE_LINE, TEE_LINE, BACK_LINE)
"""Lines a centimetre or two wide; all others are edges between two colours."""

SAMPLES = 33
"""Samples along a normal; odd, the middle one at the point itself."""

LINE_REACH = 0.05
"""Half width looked at across a thin line, m: some are painted as two stripes 3 cm apart."""

BAND = 0.08
"""Half width looked at across the edge of the hog line, m: the line is 10 cm wide."""

BLOCK = 6
"""Neighbouring normals of a thin line that are measured together."""

MOST_BLOCKS, MOST_STEPS = 18, 40
"""Most marks of a thin line, and of the edge of a wide one."""

LEAST = 8
"""Fewer normals than this are no line."""


def _candidates() -> list[tuple[int, Array]]:
    """Kinds of line, and the places along each where it may be measured."""
    angle = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    lengthwise = np.arange(-4.0, SHEET.hog_line + 3, 0.04)
    across = np.arange(-SHEET.half_width_min, SHEET.half_width_min, 0.03)
    beside = across[np.abs(across) > 0.75]  # between, the 12-ft circle touches the back line
    return [
        *((kind, angle) for kind in range(CIRCLES)),
        (LEFT, lengthwise[::3]),
        (RIGHT, lengthwise[::3]),
        (HOG_LINE, across[::2]),
        (CENTRE_LINE, lengthwise),
        (TEE_LINE, across),
        (BACK_LINE, beside),
    ]


_CANDIDATES = _candidates()
_COUNTS = [len(places) for _, places in _CANDIDATES]
_STARTS = np.concatenate([[0], np.cumsum(_COUNTS)])
_LINE = np.repeat([kind for kind, _ in _CANDIDATES], _COUNTS)
_ALONG = np.concatenate([places for _, places in _CANDIDATES])


def _neighbours() -> tuple[Index, Index]:
    """Index of the candidate after and before each one on the same line."""
    ahead, behind = np.arange(len(_LINE)) + 1, np.arange(len(_LINE)) - 1
    for (kind, _), first, last in zip(_CANDIDATES, _STARTS[:-1], _STARTS[1:], strict=True):
        closed = kind < CIRCLES
        ahead[last - 1] = first if closed else last - 1
        behind[first] = last - 1 if closed else first
    return ahead, behind


_AHEAD, _BEHIND = _neighbours()


@dataclass(frozen=True)
class Normals:
    """Places on the lines, all inside the picture.

    Attributes
    ----------
    kinds : dict of int to slice
        Which of the places lie on each kind of line.
    along : ndarray, shape (n,)
        Where along its line, as in `vision.pose.Marks`.
    point, normal : ndarray, shape (n, 2)
        Place in the picture and the unit normal there, px.
    reach : ndarray, shape (n,)
        Half length to be looked at, px.
    visible : ndarray, shape (3,)
        Fraction of each circle inside the picture.
    """

    kinds: dict[int, slice]
    along: Array
    point: Array
    normal: Array
    reach: Array
    visible: Array


def lay_out(
    view: Array,
    rig: Array,
    size: tuple[int, int],
    *,
    reach: float,
    spacing: float,
    most: int,
    lines: bool,
) -> Normals:
    """Places to measure: on the circles every `spacing` px, at most `most`; and on the lines."""
    count = len(_CANDIDATES) if lines else CIRCLES
    upto = _STARTS[count]
    place = project(ice_points(_LINE[:upto], _ALONG[:upto], rig), view, rig, size)
    step = place[_AHEAD[:upto]] - place[_BEHIND[:upto]]
    length = np.hypot(step[:, 0], step[:, 1])
    x, y = place.T
    w, h = size
    inside = (x > reach) & (y > reach) & (x < w - 1 - reach) & (y < h - 1 - reach)
    kinds: dict[int, slice] = {}
    visible = np.zeros(CIRCLES)
    picked, reaches, total = [np.zeros(0, np.int64)], [np.zeros(0)], 0
    for (kind, along), first in zip(_CANDIDATES[:count], _STARTS[:count], strict=True):
        at = np.flatnonzero(inside[first : first + len(along)]) + first
        if kind < CIRCLES:
            visible[kind] = len(at) / len(along)
        if len(at) < LEAST:
            continue
        span = float(length[at].sum()) / 2
        scale = span / (len(at) * (along[1] - along[0]))
        at = _thinned(at, kind, span / spacing, most)
        kinds[kind] = slice(total, total + len(at))
        total += len(at)
        picked.append(at)
        reaches.append(np.full(len(at), _reach(kind, reach, scale)))
    at = np.concatenate(picked)
    with np.errstate(invalid="ignore", divide="ignore"):
        normal = np.column_stack([step[at, 1], -step[at, 0]]) / length[at, None]
    return Normals(kinds, _ALONG[at], place[at], normal, np.concatenate(reaches), visible)


def _thinned(at: Index, kind: int, wanted: float, most: int) -> Index:
    """Keep as many as are wanted, evenly; of a thin line whole blocks."""
    if kind in THIN:
        blocks = at[: len(at) // BLOCK * BLOCK].reshape(-1, BLOCK)
        return blocks[:: -(-len(blocks) // MOST_BLOCKS)].ravel()
    count = int(np.clip(wanted, 12, most)) if kind < CIRCLES else MOST_STEPS
    return at if len(at) <= count else at[np.arange(count) * len(at) // count]


def _reach(kind: int, reach: float, scale: float) -> float:
    if kind in THIN:
        return max(reach, LINE_REACH * scale)
    return min(reach, BAND * scale) if kind == HOG_LINE else reach


def profiles(image: Image, normals: Normals) -> Profiles:
    """Colours along the normals, shape (n, SAMPLES, 3)."""
    s = np.linspace(-1.0, 1.0, SAMPLES, dtype=np.float32) * normals.reach[:, None]
    x, y = (
        (normals.point[:, axis, None] + normals.normal[:, axis, None] * s).astype(np.float32)
        for axis in (0, 1)
    )
    found = cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(found, np.float32)
