"""Circles drawn as outlines alone, with ice on either side: the middle of an outline is its edge.

A profile across one, added up from side to side, rises as one across the edge of paint does, half
way in the middle of the outline.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.optics.paint import CIRCLES
from curlshot.vision.sheet.edges import END, ENDS, LIGHT, MIN_CONTRAST, SHARPNESS
from curlshot.vision.sheet.normals import SAMPLES, Profiles

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

DARKER = 2.0
"""By how many times an outline must differ more from its sides than they from each other."""

ALIKE = 40.0
"""Difference of the two sides, grey levels, from which on they are not looked between."""

STRENGTH = 0.35, 1.8
"""How strong an outline may be, as a share of what is usual along it."""

UNEVEN = 14.0
"""How far its sides may be from what is usual along it, grey levels."""

FAINTEST = 0.25
"""Share of its strength below which it is taken for noise."""

_FAR = (SAMPLES - END) / 2
_OFF = (np.arange(SAMPLES) - SAMPLES // 2) / _FAR
_BETWEEN = (0.5 + 0.5 * np.outer(_OFF, [-1, 1])).astype(np.float32)


def outlines(
    profile: Profiles, kinds: dict[int, slice], value: Profiles, good: Flags, palette: Array
) -> list[slice]:
    """Tell which circles are outlines alone, and put these into what is known of edges.

    Parameters
    ----------
    profile : ndarray, shape (3, SAMPLES, n)
        Colours along normals.
    kinds : dict of int to slice
        Which of them lie on each circle.
    value, good, palette : ndarray, shapes (SAMPLES, n), (n,) and (9, 2, 3)
        As `curlshot.vision.sheet.edges.steps` found them; of outlines alone this writes the
        profiles on the scale from the sides (−0.5) to the outline (0.5), whether one is shown, and
        the sides' colours.

    Returns
    -------
    list of slice
        Which normals lie on such circles.
    """
    alone = []
    for kind in range(CIRCLES):
        apart = palette[kind, 1] - palette[kind, 0]
        if kind not in kinds or apart @ apart > ALIKE**2:
            continue
        part = kinds[kind]
        some = profile[..., part]
        ends = ENDS @ some
        usual = np.median(ends, axis=-1, keepdims=True)
        light = np.clip((ends * usual).sum(0) / np.maximum((usual * usual).sum(0), 1.0), *LIGHT)
        level = (np.square(ends - light * usual).sum(0) < UNEVEN**2).all(0)
        off = some - _BETWEEN @ ends
        most = np.square(off[:, END:-END]).sum(0).argmax(0) + END
        drawn = np.median(np.take_along_axis(off, most[None, None], 1)[:, 0], axis=-1)
        step = (usual[:, 1] - usual[:, 0])[:, 0]
        if drawn @ drawn < max(MIN_CONTRAST**2, DARKER**2 * float(step @ step)):
            continue
        axis = SHARPNESS @ drawn
        signal = np.tensordot(axis / (axis @ drawn), off, 1)
        peak = signal[END:-END].max(0)
        good[part] = level & (peak > STRENGTH[0]) & (peak < STRENGTH[1])
        value[:, part] = signal - 0.5
        alone.append(part)
        if good[part].any():
            palette[kind] = ends[..., good[part]].mean(-1).T
    return alone


def summed(value: Profiles) -> Profiles:
    """Add up profiles across outlines, shape (SAMPLES, n): from −0.5 to 0.5, 0 in the middle."""
    above = np.maximum(value + np.float32(0.5 - FAINTEST), 0)
    total = np.maximum(above.sum(0), 1e-6)
    return np.asarray((above.cumsum(0) - 0.5 * above) / total - 0.5, np.float32)
