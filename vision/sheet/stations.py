"""Stations along the painted lines: the places at which their edges may be measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE, SHEET
from curlshot.vision.optics.paint import (
    BACK_LINE,
    CENTRE_LINE,
    CIRCLES,
    HOG_LINE,
    LEFT,
    RIGHT,
    TEE_LINE,
    ice_frame,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]

THIN = (CENTRE_LINE, TEE_LINE, BACK_LINE)
"""Lines a centimetre or two wide; all others are edges between two colours."""

BLOCK = 6
"""Neighbouring stations of a thin line that are measured together."""

CLOSER = 4
"""How much closer blocks lie beyond the house: some lines are painted there alone, and end soon."""


@dataclass(frozen=True, eq=False)
class Stations:
    """Stations on some lines: k lines, n stations, in g groups that are kept or left as a whole.

    Attributes
    ----------
    kind, count, start : ndarray of int, shape (k,)
        Of each line: what it is, how many stations it has, and which is the first.
    spacing : ndarray, shape (k,)
        From one station to the next, m or rad.
    group : ndarray of int, shape (k,)
        Stations of a group: a block of a thin line, else one alone.
    groups, first_group : ndarray of int, shape (k,)
        How many groups each line has, and which is the first.
    line : ndarray of int, shape (n,)
        The kind of line of each station.
    along : ndarray, shape (n,)
        Where along its line it is, as in `curlshot.vision.optics.paint.Marks`.
    foot, way : ndarray, shape (2, n)
        Where it is on the ice, as in `curlshot.vision.optics.paint.ice_frame`.
    ahead, behind : ndarray of int, shape (n,)
        The stations after and before it on its line; at a line's end itself.
    group_size, group_start : ndarray of int, shape (g,)
        How many stations each group has, and which is the first.
    share : ndarray of int, shape (g,)
        How many groups each counts as, where some of them are to be spread along a line.
    """

    kind: Index
    count: Index
    start: Index
    spacing: Array
    group: Index
    groups: Index
    first_group: Index
    line: Index
    along: Array
    foot: Array
    way: Array
    ahead: Index
    behind: Index
    group_size: Index
    group_start: Index
    share: Index

    @classmethod
    def on(cls, lines: Sequence[tuple[int, Array]]) -> Stations:
        """Make stations on lines: of each its kind, and the places along it, evenly spaced."""
        kind = np.array([which for which, _ in lines])
        count = np.array([len(along) for _, along in lines])
        start = np.cumsum(count) - count
        line, along = np.repeat(kind, count), np.concatenate([places for _, places in lines])
        ahead, behind = np.arange(len(line)) + 1, np.arange(len(line)) - 1
        last, closed = start + count - 1, kind < CIRCLES
        ahead[last], behind[start] = np.where(closed, start, last), np.where(closed, last, start)
        group = np.where(np.isin(kind, THIN), BLOCK, 1)
        groups = count // group
        size = np.repeat(group, groups)
        first = np.cumsum(size) - size
        beyond = np.abs(along[first + size // 2]) > HOUSE.twelve_foot
        return cls(
            kind, count, start, np.array([places[1] - places[0] for _, places in lines]),
            group, groups, np.cumsum(groups) - groups, line, along, *ice_frame(line, along),
            ahead, behind, size, first, np.where((size > 1) & beyond, CLOSER, 1),
        )  # fmt: skip


def _blocks(along: Array) -> Array:
    """Leave out what is no whole block."""
    return along[: len(along) // BLOCK * BLOCK]


_ANGLE = np.linspace(-np.pi, np.pi, 360, endpoint=False)
_LENGTHWISE = np.arange(-4.0, SHEET.hog_line + 3, 0.04)
_ACROSS = np.arange(-SHEET.half_width_min, SHEET.half_width_min, 0.03)
# Between, the 12-ft circle touches the back line.
_BESIDE = _blocks(np.arange(0.76, SHEET.half_width_min, 0.03))

_ON_CIRCLES = [(kind, _ANGLE) for kind in range(CIRCLES)]

ON_CIRCLES = Stations.on(_ON_CIRCLES)
"""Those on the three circles."""


def _on_all(lengthwise: Array) -> Stations:
    return Stations.on(
        [
            *_ON_CIRCLES,
            (LEFT, lengthwise[::3]),
            (RIGHT, lengthwise[::3]),
            (HOG_LINE, _ACROSS[::2]),
            (CENTRE_LINE, _blocks(lengthwise)),
            (TEE_LINE, _blocks(_ACROSS)),
            (BACK_LINE, np.concatenate([-_BESIDE[::-1], _BESIDE])),
        ]
    )


ON_ALL, ON_ALL_DOWN = _on_all(_LENGTHWISE), _on_all(-_LENGTHWISE[::-1])
"""Those on all lines, thin ones last; where the hog line is towards −y."""
