"""Thin lines in the ice: where the profiles across them leave the mean of their two sides.

A line a centimetre wide is faint: darker than ice, perhaps lighter than paint. So neighbouring
profiles are averaged in blocks, and the line is the straight path across a run of blocks along
which they deviate most, in whatever direction of colour. All lines are measured at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.normals import BLOCK, LEAST_BLOCKS, SAMPLES, THIN, Normals, Profiles
from vision.runs import Runs

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

FAINT = 1.5
"""Grey levels that a thin line must stand out by to count half."""

CLEAR, CLEAR_BEYOND = 0.6, 0.75
"""How clear a thin line must be all along, or beyond the house if it ends there; 1 for strong
everywhere."""

STRIPES_SD = 0.025
"""Width of the bell that a thin line is smoothed with, m: two stripes become one."""

SHOWN = 0.4
"""How clear it is in a block that shows it."""

CALM = 12.0
"""Where the sides of a thin line differ by more it is something else, grey levels."""

_END = SAMPLES // 5
_ENDS = np.zeros((2, SAMPLES), np.float32)
_ENDS[0, :_END] = _ENDS[1, -_END:] = 1 / _END
_SLANT = (np.arange(SAMPLES, dtype=np.float32) - SAMPLES // 2) / (SAMPLES - _END)
_LEVEL = np.eye(SAMPLES, dtype=np.float32) - np.stack([0.5 - _SLANT, 0.5 + _SLANT], 1) @ _ENDS
"""Takes the straight course from end to end off a profile."""

_TURNS = np.arange(_END, SAMPLES - _END, 2)
_FROM, _TO = (ends.reshape(-1, 1) for ends in np.meshgrid(_TURNS, _TURNS, indexing="ij"))
"""Samples at which straight paths begin and end."""


@dataclass(frozen=True)
class Stripes:
    """Blocks of normals across thin lines.

    Attributes
    ----------
    kinds : dict of int to slice
        Which of the blocks lie on each kind of line.
    along, offset : ndarray, shape (n,)
        Middle along the line, m, and how far along the normal the line is, px.
    point, normal : ndarray, shape (n, 2)
        Middle of the block and its unit normal, px.
    good : ndarray of bool, shape (n,)
        Whether the line was made out.
    """

    kinds: dict[int, slice]
    along: Array
    offset: Array
    point: Array
    normal: Array
    good: Flags


def find_stripes(profile: Profiles, normals: Normals) -> Stripes:
    """Measure the thin lines.

    Parameters
    ----------
    profile : ndarray, shape (n, SAMPLES, channels)
        Along all of the normals.
    """
    parts = {kind: normals.kinds[kind] for kind in THIN if kind in normals.kinds}
    if not parts:
        none = np.zeros((0, 2))
        return Stripes({}, np.zeros(0), np.zeros(0), none, none, np.zeros(0, bool))
    begin = min(part.start for part in parts.values())
    kinds = {
        kind: slice((part.start - begin) // BLOCK, (part.stop - begin) // BLOCK)
        for kind, part in parts.items()
    }
    along = normals.along[begin:].reshape(-1, BLOCK).mean(1)
    point = normals.point[begin:].reshape(-1, BLOCK, 2).mean(1)
    normal = normals.normal[begin:].reshape(-1, BLOCK, 2).mean(1)
    step = 2 * normals.reach[begin::BLOCK] / (SAMPLES - 1)
    blocks = profile[begin:].reshape(-1, BLOCK, *profile.shape[1:]).mean(1)
    ends = _ENDS @ blocks
    flat = _LEVEL @ blocks
    calm = ((ends[:, 1] - ends[:, 0]) ** 2).sum(1) < CALM**2
    for part in kinds.values():
        scale = np.hypot(*(point[part.stop - 1] - point[part.start]))
        scale /= abs(along[part.stop - 1] - along[part.start])
        flat[part] = _bell(round(4 * STRIPES_SD * scale / step[part.start]) / 4) @ flat[part]
    # Darker than the ice, perhaps lighter than the paint: only the size of the deviation counts.
    value = np.sqrt((flat * flat).sum(2))
    runs = Runs.of(list(kinds.values()))
    sample, good = _paths(value[runs.index], along[runs.index], calm[runs.index] & runs.real)
    offset, found = np.zeros(len(along)), np.zeros(len(along), bool)
    offset[runs.index[runs.real]] = sample[runs.real]
    found[runs.index[runs.real]] = good[runs.real]
    return Stripes(kinds, along, step * (offset - SAMPLES // 2), point, normal, found)


def _paths(value: Profiles, along: Array, use: Flags) -> tuple[Array, Flags]:
    """Find the straight paths across profiles along which they are highest.

    Parameters
    ----------
    value : ndarray, shape (lines, blocks, SAMPLES)
    along : ndarray, shape (lines, blocks)
    use : ndarray of bool, shape (lines, blocks)

    Returns
    -------
    sample, good : ndarray, shape (lines, blocks)
        Where the profiles are highest near the path, and whether they show the line.
    """
    beyond = use & (np.abs(along) > HOUSE.twelve_foot)
    share = along - along[:, :1]
    share /= share[:, -1:]
    path = np.round(_FROM + (_TO - _FROM) * share[:, None]).astype(np.int64)
    clear = value / (value.max(2, keepdims=True) + FAINT) * use[..., None]
    line, block = np.ogrid[: len(value), : value.shape[1]]
    course = clear[line[..., None], block, path]
    strength = np.zeros(course.shape[:2], np.float32)
    for part, least in ((use, CLEAR), (beyond, CLEAR_BEYOND)):
        count = part.sum(1)[:, None]
        mean = (course * part[:, None]).sum(2) / np.maximum(count, 1) / least
        strength = np.maximum(strength, np.where(count >= LEAST_BLOCKS, mean, 0.0))
    best = strength.argmax(1)
    highest = strength.max(1)
    middle = path[line[:, 0], best]
    near = clear[line[..., None], block[..., None], middle[..., None] + np.arange(-2, 3)]
    top = near[..., 1:-1].argmax(2) + 1
    low, height, high = (near[line, block, top + aside] for aside in (-1, 0, 1))
    bend = np.maximum(2 * height - low - high, 1e-9)
    good = use & (height > SHOWN) & (height >= low) & (height >= high)
    good &= (highest >= 1)[:, None]
    good &= (good.sum(1) >= LEAST_BLOCKS)[:, None]
    return middle + top - 2 + 0.5 * (high - low) / bend, good


@lru_cache(maxsize=256)
def _bell(sd: float) -> Profiles:
    """Matrix that smooths profiles by a bell of `sd` samples, (SAMPLES, SAMPLES)."""
    away = np.arange(SAMPLES)[:, None] - np.arange(SAMPLES)
    weight = np.exp(-0.5 * (away / max(sd, 1.0)) ** 2)
    return np.asarray(weight / weight.sum(1, keepdims=True), np.float32)
