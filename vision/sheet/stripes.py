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

from curlshot.data.sheet import HOUSE
from curlshot.vision.sheet.normals import LEAST_BLOCKS, SAMPLES, Normals, Profiles, means_of_ends
from curlshot.vision.sheet.runs import Runs
from curlshot.vision.sheet.stations import BLOCK, THIN

Array = NDArray[np.float64]
Index = NDArray[np.int64]
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
_ENDS = means_of_ends(_END)
_SLANT = (np.arange(SAMPLES, dtype=np.float32) - SAMPLES // 2) / (SAMPLES - _END)
_LEVEL = np.eye(SAMPLES, dtype=np.float32) - np.stack([0.5 - _SLANT, 0.5 + _SLANT], 1) @ _ENDS
"""Takes the straight course from end to end off a profile."""

_CLEAR = np.array([CLEAR, CLEAR_BEYOND], np.float32)
_ASIDE = np.arange(-1, 2)

_TURNS = np.arange(_END, SAMPLES - _END, 2)
_FROM, _TO = (ends.reshape(-1, 1) for ends in np.meshgrid(_TURNS, _TURNS, indexing="ij"))
"""Samples at which straight paths begin and end."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """Blocks of neighbouring normals across thin lines.

    Attributes
    ----------
    kinds : dict of int to slice
        Which of the blocks lie on each kind of line.
    along : ndarray, shape (n,)
        Middle along the line, m.
    normal : ndarray, shape (2, n)
        Mean unit normal.
    reach : ndarray, shape (n,)
        Half length to be looked at, px.
    mean : ndarray of float32, shape (normals, n)
        Takes the means over the blocks.
    bells : list of ndarray, shape (SAMPLES, SAMPLES)
        Smooth the profiles across each line until two stripes are one.
    runs : Runs
        The blocks along each line.
    beyond : ndarray of bool, shape (lines, longest)
        Which of the blocks along each line lie beyond the house.
    path : ndarray of int, shape (lines, paths, longest)
        Where straight paths across each line's profiles run in a list of all of these.
    """

    kinds: dict[int, slice]
    along: Array
    normal: Array
    reach: Array
    mean: Profiles
    bells: list[Profiles]
    runs: Runs
    beyond: Flags
    path: Index

    @classmethod
    def of(cls, normals: Normals) -> Blocks:
        """Make blocks of the normals across thin lines."""
        first = normals.wide
        parts = {kind: normals.kinds[kind] for kind in THIN if kind in normals.kinds}
        kinds = {
            kind: slice((part.start - first) // BLOCK, (part.stop - first) // BLOCK)
            for kind, part in parts.items()
        }
        along, normal, point = (
            values[..., first:].reshape(*values.shape[:-1], -1, BLOCK).mean(-1)
            for values in (normals.along, normals.normal, normals.point)
        )
        reach = normals.reach[first::BLOCK]
        mean = np.repeat(np.eye(len(along)) / BLOCK, BLOCK, axis=0).astype(np.float32)
        bells = []
        for part in kinds.values():
            ends = [part.start, part.stop - 1]
            scale = np.hypot(*np.diff(point[:, ends])[:, 0]) / abs(np.diff(along[ends])[0])
            step = 2 * reach[part.start] / (SAMPLES - 1)
            bells.append(_bell(round(4 * STRIPES_SD * scale / step) / 4))
        runs = Runs.of(list(kinds.values()))
        rows = along[runs.index]
        share = rows - rows[:, :1]
        share /= share[:, -1:]
        path = np.round(_FROM + (_TO - _FROM) * share[:, None]).astype(np.int64)
        path += SAMPLES * np.arange(share.size).reshape(share.shape)[:, None]
        beyond = np.abs(rows) > HOUSE.twelve_foot
        return cls(kinds, along, normal, reach, mean, bells, runs, beyond, path)


def find_stripes(profile: Profiles, blocks: Blocks, within: Flags) -> tuple[Array, Flags]:
    """Measure the thin lines.

    Parameters
    ----------
    profile : ndarray, shape (..., channels, SAMPLES, normals)
        Along the normals across thin lines, in one or more pictures.
    blocks : Blocks
    within : ndarray of bool, shape (..., n)
        Which blocks are in the picture.

    Returns
    -------
    offset, good : ndarray, shape (..., n)
        How far along its normal each block shows the line, px, and whether it does.
    """
    shape = (*profile.shape[:-3], len(blocks.along))
    offset, good = np.zeros(shape), np.zeros(shape, bool)
    if not blocks.kinds:
        return offset, good
    means = profile @ blocks.mean
    ends, flat = _ENDS @ means, _LEVEL @ means
    calm = within & (((ends[..., 1, :] - ends[..., 0, :]) ** 2).sum(-2) < CALM**2)
    for part, bell in zip(blocks.kinds.values(), blocks.bells, strict=True):
        flat[..., part] = bell @ flat[..., part]
    # Darker than the ice, perhaps lighter than the paint: only the size of the deviation counts.
    value = np.swapaxes(np.sqrt((flat * flat).sum(-3)), -1, -2)
    index, real = blocks.runs.index, blocks.runs.real
    sample, shown = _paths(value[..., index, :], blocks, calm[..., index] & real)
    offset[..., index[real]] = sample[..., real] / (SAMPLES // 2) - 1
    good[..., index[real]] = shown[..., real]
    return offset * blocks.reach, good


def _paths(value: Profiles, blocks: Blocks, use: Flags) -> tuple[Array, Flags]:
    """Find the straight paths across profiles along which they are highest.

    Parameters
    ----------
    value : ndarray, shape (..., lines, longest, SAMPLES)
    blocks : Blocks
    use : ndarray of bool, shape (..., lines, longest)

    Returns
    -------
    sample, good : ndarray, shape (..., lines, longest)
        Where the profiles are highest near the path, and whether they show the line.
    """
    clear = (value / (value.max(-1, keepdims=True) + FAINT) * use[..., None]).reshape(
        *use.shape[:-2], -1
    )
    part = np.stack([use, use & blocks.beyond], axis=-1).astype(np.float32)
    count = part.sum(-2, keepdims=True)
    part *= (count >= LEAST_BLOCKS) / (np.maximum(count, 1) * _CLEAR)
    strength = (clear[..., blocks.path] @ part).max(-1)
    path = blocks.path[np.arange(use.shape[-2]), strength.argmax(-1)]

    def at(sample: Index) -> Profiles:
        flat = np.take_along_axis(clear, sample.reshape(*clear.shape[:-1], -1), -1)
        return flat.reshape(sample.shape)

    top = path + at(path[..., None] + _ASIDE).argmax(-1) - 1
    low, height, high = at(top - 1), at(top), at(top + 1)
    bend = np.maximum(2 * height - low - high, 1e-9)
    good = use & (height > SHOWN) & (height >= low) & (height >= high)
    good &= (strength.max(-1) >= 1)[..., None]
    good &= (good.sum(-1) >= LEAST_BLOCKS)[..., None]
    return top % SAMPLES + 0.5 * (high - low) / bend, good


@lru_cache(maxsize=256)
def _bell(sd: float) -> Profiles:
    """Matrix that smooths profiles by a bell of `sd` samples, (SAMPLES, SAMPLES)."""
    away = np.arange(SAMPLES)[:, None] - np.arange(SAMPLES)
    weight = np.exp(-0.5 * (away / max(sd, 1.0)) ** 2)
    # Beyond the ends there is nothing: to scale it up there would draw a line outwards.
    return np.asarray(weight / weight[SAMPLES // 2].sum(), np.float32)
