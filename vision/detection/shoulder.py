"""Where a cap ends whose far shoulder hides behind it: against what lies beyond, not its granite.

Steeply aslant no granite shows at the far edge of a cap: ice or paint follows at once. Half-way
from the cap to its granite is no edge there, the less as light mixes before it is coded
(`vision.sheet.mixing`): of a dark cap before bright ice that level lies inside it, by half a pixel,
which aslant is 5 to 10 mm.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from data.sheet import Stone
from vision.detection.contrast import mean_colours
from vision.detection.rays import Rays

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]

HIDDEN = 0.85, 1.0
"""Slants along a ray from which on, and from which on surely, granite hides behind the cap."""

POWER = 1.6
"""Power of codes that mixes: light is one of 2.2, but later steps (resizing, coding of colours)
blur codes. Between both: of 60 caps seen steeply, renderers that mix light say more, one that mixes
codes says 1."""

MIXED = 0.15, 0.25
"""How far what lies between a cap and what is beyond may be from any mixture of both, in steps from
one to the other, and from where on it is a colour of its own: granite that shows after all."""

BEGIN, END = 0.9, 1.15
"""Where that is looked at, in radii of the cap: up to where rays leave the height of its edge."""

LEAST = 0.02
"""Squared difference of light, of 1 for white, below which nothing tells a cap from what is there.
"""

_LIGHT = ((np.arange(256) / 255) ** POWER).astype(np.float32)


def against_beyond(signal: Floats, rays: Rays, behind: Array, of_cap: Flags, disc: Stone) -> Floats:
    """Say how much of a cap is on rays about n places, where nothing of its granite is.

    Parameters
    ----------
    signal : ndarray, shape (n, rays, radii)
        0.5 on the cap, −0.5 on its granite.
    rays : Rays
    behind : ndarray, shape (n, rays)
        Slant of the view along each ray, above 0 on the far side.
    of_cap : ndarray of bool, shape (n, rays, well within the cap)
        Samples that show the cap.
    disc : Stone
        Size of the stones.

    Returns
    -------
    ndarray, shape (n, rays, radii)
        The same, but on rays that look over the cap −0.5 on what lies beyond.
    """
    place, ray = np.nonzero(behind > HIDDEN[0])
    if not len(place):
        return signal
    rows, row = np.unique(place, return_inverse=True)
    inner = _LIGHT[rays.bgr[rows][:, :, : of_cap.shape[-1]]]
    cap = mean_colours(inner, of_cap[rows].astype(np.float32))[row].astype(np.float32)
    begin, end = np.searchsorted(rays.radius, np.array([BEGIN, END]) * disc.cap_radius) - [0, 1]
    light = _LIGHT[rays.bgr[place, ray]]
    beyond = light[:, end]
    apart, over = cap - beyond, light - beyond[:, None]
    size = np.maximum((apart**2).sum(1), LEAST)[:, None]
    share = (over @ apart[..., None])[..., 0] / size
    odd = np.sqrt(((over - share[..., None] * apart[:, None]) ** 2).sum(-1) / size)
    worst = odd[:, begin:end].max(1)
    odd_at = np.array([np.median(worst[row == k]) for k in range(len(rows))])[row]
    share[:, end:] = 0
    trust = np.interp(behind[place, ray], HIDDEN, (0, 1)) * np.interp(odd_at, MIXED, (1, 0))
    trust *= size[:, 0] > LEAST
    out = signal.copy()
    out[place, ray] += trust[:, None].astype(np.float32) * (share - 0.5 - signal[place, ray])
    return out
