"""How large the caps of a clip's stones are: as usual, or of what size most places say.

Stones that are drawn may have caps of any size, all of a clip of one. Each place that answers like
a stone has a say: for the radius that parts it best into a cap and its granite, whatever their
colours are (Otsu's criterion: the variance between the two).
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import Appearance, membership
from curlshot.vision.detection.ice_map import IceMap
from curlshot.vision.detection.patch import CAP_END, RING_BEGIN, RING_END
from curlshot.vision.video.colour import lab_of
from curlshot.vision.video.picture import colours_at

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

CAPS = 0.94 * 1.06 ** np.arange(-11.0, 1)
"""Radii of caps that are asked for, as shares of the stone's."""

LIGHT = 0.3
"""What a difference of lightness counts beside one of hue: handles and bolts are light or dark."""

OUTER = 0.97
"""Up to where granite is looked at, in radii of the stone."""

LEAST, ALONE = 0.6, 0.4
"""From where on a place has a say: answer to the template of a stone, 0 to 2; and where nothing is
known of colours, share of its variance that is between cap and granite."""

USUAL = 0.8
"""Share of the best size's say above which the usual size stays: of 127 real frames it has at least
0.87."""

MUCH = 0.6
"""Share of the best size's say from which another one may be right."""

NO_BALLOT: Array = np.zeros(len(CAPS))
"""What places say if there are none."""


def elected(say: Array, disc: Stone) -> list[Stone]:
    """Give the usual stone, and it with caps for which more is said, most first: see `ballot`.

    What hides a part of a cap, if only the picture's edge, has a say for a smaller one.
    """
    best = float(say.max())
    if np.interp(disc.cap_radius / disc.radius, CAPS, say) >= USUAL * best:
        return [disc]
    order = np.argsort(-say)
    others = [
        replace(disc, cap_radius=float(CAPS[k] * disc.radius))
        for k in order
        if say[k] > MUCH * best
    ]
    return [disc, *others[:3]]


def ballot(ice: IceMap, appearance: Appearance, places: Array, disc: Stone) -> Array:
    """Ask places how large caps are.

    Parameters
    ----------
    ice : IceMap
    appearance : Appearance
        By what they were sought.
    places : ndarray, shape (n, 2)
        Columns and rows of the map.
    disc : Stone
        The usual stone.

    Returns
    -------
    ndarray, shape (sizes,)
        What is said for each of `CAPS`.
    """
    if not len(places):
        return NO_BALLOT
    half = int(np.ceil(disc.radius * ice.scale))
    offset = np.arange(-half, half + 1, dtype=np.float32)
    x, y = (places.astype(np.float32)[:, k, None, None] for k in (0, 1))
    x, y = (
        axis.reshape(-1, len(offset))
        for axis in np.broadcast_arrays(x + offset, y + offset[:, None])
    )
    around = colours_at(ice.image, x, y)
    lab = lab_of(around).astype(np.float32).reshape(len(places), -1, 3)
    lab *= np.array([LIGHT, 1, 1], np.float32)
    apart, areas, whole, template = _kernels(disc.radius * ice.scale, half)
    between = ((lab.transpose(0, 2, 1) @ apart) ** 2).sum(1) * areas
    most = np.maximum(between.max(1), 1e-9)
    if appearance.membership is None:
        all_of_it = (whole @ lab**2 - (whole @ lab) ** 2).sum(1)
        answer = most / np.maximum(all_of_it, 1e-9) - ALONE
    else:
        worth = membership(around, appearance.membership).reshape(len(places), -1)
        answer = (worth @ template).max(1) - LEAST
    return np.asarray(np.maximum(answer, 0) ** 2 @ (between / most[:, None]) ** 3, float)


@lru_cache(maxsize=4)
def _kernels(radius_px: float, half: int) -> tuple[Floats, Array, Floats, Floats]:
    """Weights of pixels about a stone for each size of its cap.

    Returns
    -------
    apart : ndarray, shape (px, sizes)
        Of the mean over the cap less that over what is around it.
    areas : ndarray, shape (sizes,)
        Product of the areas of both, shares of the whole.
    whole : ndarray, shape (px,)
        Of the mean over both.
    template : ndarray, shape (px, sizes)
        As `apart`, edges left out, as `curlshot.vision.detection.seek` has it.
    """
    fine, pixels = 4, 2 * half + 1
    offset = (np.arange(pixels * fine) - (pixels * fine - 1) / 2) / fine / radius_px
    r = np.hypot(*np.meshgrid(offset, offset))[..., None]
    begin, end = (CAPS + share * (1 - CAPS) for share in (RING_BEGIN, RING_END))
    cap, around, core, ring = (
        part.reshape(pixels, fine, pixels, fine, -1).mean((1, 3)).reshape(-1, len(CAPS))
        for part in (
            r < CAPS, (r >= CAPS) & (r < OUTER), r < CAP_END * CAPS, (r >= begin) & (r < end),
        )
    )  # fmt: skip
    whole = (cap + around)[:, 0]
    areas = cap.sum(0) * around.sum(0) / whole.sum() ** 2
    mean, beside, middle, granite = (
        np.asarray(part / np.maximum(part.sum(0), 1e-9), np.float32)
        for part in (cap, around, core, ring)
    )
    weight = np.asarray(whole / whole.sum(), np.float32)
    return mean - beside, areas, weight, middle - granite
