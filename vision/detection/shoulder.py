"""Where a cap with a hue ends whose granite hides behind it: by a model of what its pixels mix.

Steeply aslant hardly any granite shows at the far edge of a cap, and ice or paint follows. Half-way
from the cap to its granite is no edge there: of a cap before dark paint that level lies inside it,
by up to half a pixel, which aslant is 5 to 10 mm. Nor is half-way to what lies beyond: a pixel off
a cap its hue still tinges that, and the granite between shows before paint, but not before ice,
which is as grey. Codes are compared, not the light that they stand for: colours are blurred most by
being coded half as finely as lightness, and that mixes codes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.contrast import mean_colours
from curlshot.vision.detection.mixture import (
    INNER,
    WITHIN,
    CapRays,
    around,
    granite_seen,
    moved,
    past,
)
from curlshot.vision.video.picture import TO_CHROMA

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]

HIDDEN = 0.85, 1.0
"""Slants along a ray from which on, and from which on surely, granite hides behind the cap."""

BLUR = np.array([0.75, 1.25, 1.25])
"""Standard deviations of what blurs luma and both chromas, px: a pixel, a lens, a codec, and
samples of chroma for two pixels. Beyond caps of drawn clips .11 of the cap's chroma is left at 1.2
pixels, .05 at 1.8."""

USUAL_FULLNESS = 0.5
"""How far from slim to full shoulders the granite is taken to show: between what is known of real
stones and the slimmest that are drawn. What is not so moves a place by some mm, but everywhere
alike; told anew at each place, it would change with what lies beyond."""

BEYOND = 1.6
"""How many pixels past such granite a ray shows what lies beyond it alone."""

MISFIT = 0.15, 0.3
"""Root mean square of what is left, as a share of the step, from which on and from which on surely
a ray shows something else: a handle that stands up before the edge, a line, another stone."""

LEAST = 36.0
"""Difference of luma and chromas, codes, below which nothing tells a cap from what is there."""


def against_beyond(signal: Floats, seen: CapRays, disc: Stone) -> Floats:
    """Say how much of a cap is on rays about n places, where it hides its granite.

    Parameters
    ----------
    signal : ndarray, shape (n, rays, radii)
        0.5 on the cap, −0.5 on its granite.
    seen : CapRays
        What is seen there.
    disc : Stone
        Size of the stones.

    Returns
    -------
    ndarray, shape (n, rays, radii)
        The same, but on rays that look over the cap −0.5 on whatever is beyond its edge.
    """
    place, ray = np.nonzero(seen.behind > HIDDEN[0])
    if not len(place):
        return signal
    bgr, over = seen.rays.bgr, seen.over
    cap = _mean(bgr[:, :, : seen.of_cap.shape[-1]], seen.of_cap)[place]
    granite = _mean(bgr[:, :, seen.in_ring], seen.of_ring)[place]
    slant, along = seen.behind[place, ray], seen.pixel_along(place, ray)
    radii, radius = seen.rays.radius, seen.radius
    slim, full = granite_seen(slant, disc)
    strip = slim + USUAL_FULLNESS * (full - slim)
    end = np.searchsorted(radii, radius + full + BEYOND * along).clip(max=len(radii) - 1)
    codes = np.swapaxes(over.bgr[place, ray] @ TO_CHROMA.T, 1, 2)
    beyond = codes[np.arange(len(place)), :, end]
    # Lamps and the handle lighten a cap here and there, but its hue is one.
    low, high = np.searchsorted(radii, np.array(INNER) * radius)
    cap[:, 0] = np.median(codes[:, 0, low:high], axis=1)
    inside = over.inside[place, ray]
    used = inside & (radii > radius - WITHIN) & (np.arange(len(radii)) <= end[:, None])
    beside, blur = around(radii, radius), (along[:, None] * BLUR)[..., None]
    ends = (granite - cap)[..., None] * past(beside / blur)
    ends += (beyond - granite)[..., None] * past((beside - strip[:, None, None]) / blur)
    samples, least = moved(cap[..., None] + ends, codes, used)
    at = radius + float(radii[1] - radii[0]) * samples
    apart = ((cap - beyond) ** 2).sum(1)
    odd = np.sqrt(least / np.maximum(apart, LEAST**2))
    trust = np.interp(slant, HIDDEN, (0, 1)) * np.interp(odd, MISFIT, (1, 0))
    trust *= inside[np.arange(len(place)), end] & (apart > LEAST**2)
    share = 0.5 - past((radii - at[:, None]) / (BLUR[0] * along[:, None]))
    out = signal.copy()
    out[place, ray] += (trust[:, None] * (share - signal[place, ray])).astype(np.float32)
    return out


def _mean(bgr: Bytes, use: Flags) -> Array:
    """Mean luma and chromas of the samples chosen, shape (n, 3)."""
    return np.asarray(mean_colours(bgr.astype(np.float32), use.astype(np.float32)) @ TO_CHROMA.T)
