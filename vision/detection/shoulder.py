"""Where a cap ends whose far shoulder hides behind it: against what lies beyond, not its granite.

Steeply aslant no granite shows at the far edge of a cap: ice or paint follows at once. Half-way
from the cap to its granite is no edge there: of a cap before dark paint that level lies inside it,
by up to half a pixel, which aslant is 5 to 10 mm. Codes are compared, not the light that they stand
for: colours are blurred most by being coded half as finely as lightness, and that mixes codes.
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

MIXED = 0.15, 0.25
"""How far what lies between a cap and what is beyond may be from any mixture of both, in steps from
one to the other, and from where on it is a colour of its own: granite that shows after all."""

BEGIN, REACH = 0.9, 1.2
"""Where that is looked at: from so many radii of the cap on, up to so many pixels beyond it. Colour
is coded half as finely as lightness: nearer than that, what is beyond still looks like the cap."""

LEAST = 36.0
"""Difference of colours, codes, below which nothing tells a cap from what is there."""


def against_beyond(
    signal: Floats, rays: Rays, behind: Array, of_cap: Flags, disc: Stone, pixel: Array
) -> Floats:
    """Say how much of a cap is on rays about n places, where nothing of its granite is.

    Parameters
    ----------
    signal : ndarray, shape (n, rays, radii)
        0.5 on the cap, −0.5 on its granite.
    rays : Rays
        That stay at the height of the cap (`vision.detection.patch.over_caps`).
    behind : ndarray, shape (n, rays)
        Slant of the view along each ray, above 0 on the far side.
    of_cap : ndarray of bool, shape (n, rays, well within the cap)
        Samples that show the cap.
    disc : Stone
        Size of the stones.
    pixel : ndarray, shape (n,)
        How long a pixel is there, m.

    Returns
    -------
    ndarray, shape (n, rays, radii)
        The same, but on rays that look over the cap −0.5 on what lies beyond.
    """
    place, ray = np.nonzero(behind > HIDDEN[0])
    if not len(place):
        return signal
    rows, row = np.unique(place, return_inverse=True)
    inner = rays.bgr[rows][:, :, : of_cap.shape[-1]].astype(np.float32)
    cap = mean_colours(inner, of_cap[rows].astype(np.float32))[row].astype(np.float32)
    # `pixel` is the mean of its two sides: along the slant it is so much longer.
    along = pixel[place] * (1 + behind[place, ray] ** 2) ** 0.25
    radius = rays.radius
    end = np.searchsorted(radius, disc.cap_radius + REACH * along).clip(max=len(radius) - 1)
    seen = rays.bgr[place, ray].astype(np.float32)
    each = np.arange(len(place))
    beyond = seen[each, end]
    apart, over = cap - beyond, seen - beyond[:, None]
    size = np.maximum((apart**2).sum(1), LEAST**2)[:, None]
    share = (over @ apart[..., None])[..., 0] / size
    odd = np.sqrt(((over - share[..., None] * apart[:, None]) ** 2).sum(-1) / size)
    past = np.arange(len(radius)) >= end[:, None]
    worst = np.where(past | (radius < BEGIN * disc.cap_radius), 0.0, odd).max(1)
    odd_at = np.array([np.median(worst[row == k]) for k in range(len(rows))])[row]
    share[past] = 0
    trust = np.interp(behind[place, ray], HIDDEN, (0, 1)) * np.interp(odd_at, MIXED, (1, 0))
    trust *= rays.inside[place, ray, end] & (size[:, 0] > LEAST**2)
    out = signal.copy()
    out[place, ray] += trust[:, None].astype(np.float32) * (share - 0.5 - signal[place, ray])
    return out
