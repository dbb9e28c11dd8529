"""Where a black or grey cap ends: by a model of what its pixels mix (partial area effect).

Ice is as grey as granite, but lighter by more than granite is lighter than such a cap. On the far
side of a slanting view little granite is seen, or none, and pixels mix all three: half-way from cap
to granite then lies up to half a pixel inside the cap, and what falls most may be the edge of the
granite. (The hue of ice is that of granite, so that caps with a hue do not suffer.) Light is mixed
before it is coded, which draws the edges of dark caps inwards by some tenths of a pixel more.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import erf, sqrt

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.rays import Rays

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]

GAMMA = 1.6
"""What is mixed is as this power of codes: between light, which a lens blurs (2.2), and the codes
themselves, which a computer blurs that makes a picture smaller (1)."""

SLANT = 0.2
"""Slant along a ray from which on the ice beyond is looked at: nearer to the vertical the granite
is several pixels wide."""

SLIM = (0.2, 0.35, 0.5, 0.67, 0.8, 0.9), (0.030, 0.021, 0.015, 0.008, 0.003, 0.0)
FULL = (0.2, 0.35, 0.5, 0.67, 0.8, 1.0, 1.3), (0.032, 0.027, 0.023, 0.020, 0.018, 0.015, 0.012)
"""Slants along a ray, and how much granite is seen there beyond a usual cap, m as on the ice: of
stones that are drawn with slim shoulders, and of real ones (a silhouette in a television picture).
What others draw lies between."""

FULLNESS = np.linspace(0.0, 1.0, 5)
USUAL_FULLNESS = 0.75, 0.35
"""Shares of the way from slim to full shoulders that are tried, and what is known beforehand: of
real stones and of those of three makers who draw them."""

SAMPLES = 10.0
"""As how many samples those of a place count: neighbours err alike."""

BLUR = 0.75
"""Standard deviation of what blurs an edge, px: the area of a pixel, a lens, a codec."""

ASIDE = 7
"""How far from where it is looked for the edge may be, samples of a ray."""

WITHIN, BEYOND = 0.025, 2.0
"""From how far within the edge a ray is looked at, m, and how many pixels beyond the granite it is
the ice alone."""

INNER = 0.5, 0.75
"""Where a ray shows the light of the cap on its side, in radii of the cap."""

MISFIT = 0.12
"""Root mean square of what is left, as a share of the largest step, beyond which a ray shows
something else: another stone, a line, somebody's shadow."""


@dataclass(frozen=True)
class CapRays:
    """What is seen on rays about n caps, to model where each cap ends.

    Attributes
    ----------
    rays, over : Rays
        Such as fall off with the granite, and such as stay at the height of the cap
        (`curlshot.vision.detection.patch.over_caps`).
    behind : ndarray, shape (n, rays)
        Slant of the view along each ray, above 0 on the far side.
    of_cap : ndarray of bool, shape (n, rays, well within the cap)
        Samples that show the cap.
    in_ring : slice
        Radii that lie on the granite.
    of_ring : ndarray of bool, shape (n, rays, well within the granite)
        Samples there that show it.
    radius : float
        Where caps are seen to end, m.
    pixel : ndarray, shape (n,)
        How long a pixel is there, m.
    """

    rays: Rays
    over: Rays
    behind: Array
    of_cap: Flags
    in_ring: slice
    of_ring: Flags
    radius: float
    pixel: Array

    def at_places(self, index: NDArray[np.intp]) -> CapRays:
        """Take those about some of the places."""
        return CapRays(
            self.rays.at_places(index),
            self.over.at_places(index),
            self.behind[index],
            self.of_cap[index],
            self.in_ring,
            self.of_ring[index],
            self.radius,
            self.pixel[index],
        )

    def pixel_along(self, place: NDArray[np.intp], ray: NDArray[np.intp]) -> Array:
        """How long a pixel is along some rays, m: `pixel` is the mean of its two sides."""
        return np.asarray(self.pixel[place] * (1 + self.behind[place, ray] ** 2) ** 0.25)


def light_of(bgr: Bytes) -> Array:
    """Light of colours, shape (..., 3), for which codes of all channels stand, 0 to 1."""
    return np.asarray(_LIGHT[bgr].mean(-1))


_LIGHT = (np.arange(256) / 255) ** GAMMA


_BLURS = np.linspace(-4, 4, 321)
_PAST = np.array([0.5 + 0.5 * erf(blurs / sqrt(2)) for blurs in _BLURS])


def past(blurs: Array) -> Array:
    """Share of a blurred place past an edge, of which its middle is as many blurs past."""
    return np.asarray(np.interp(blurs, _BLURS, _PAST))


def around(radii: Array, radius: float) -> Array:
    """How far beyond an edge samples of a ray lie, m, and ASIDE more before and after them."""
    step = float(radii[1] - radii[0])
    return np.asarray(radii[0] - radius + step * np.arange(-ASIDE, len(radii) + ASIDE))


def moved(model: Array, seen: Array, used: Flags) -> tuple[Array, Array]:
    """Find how far models must be moved outwards to be what is seen on m rays: by least squares.

    Parameters
    ----------
    model : ndarray, shape (m, channels, radii + 2 · ASIDE)
        Of the samples, and of as many more on either side as it may be moved.
    seen : ndarray, shape (m, channels, radii)
    used : ndarray of bool, shape (m, radii)
        Samples that count.

    Returns
    -------
    samples, misfit : ndarray, shape (m,)
        How far, by parts of samples, and the mean square of what is left, summed over channels.
    """
    each, some = np.arange(len(seen)), np.flatnonzero(used.any(0))
    part = slice(some[0], some[-1] + 1) if len(some) else slice(0, 1)
    seen, used = seen[:, :, part], used[:, part]
    model = model[:, :, part.start : part.stop + 2 * ASIDE]
    at = sliding_window_view(model, seen.shape[-1], axis=2)[:, :, ::-1]  # by -ASIDE to ASIDE
    left = (((at - seen[:, :, None]) ** 2).sum(1) * used[:, None]).sum(-1)
    left /= np.maximum(used.sum(-1), 1)[:, None]
    best = left.argmin(1).clip(1, 2 * ASIDE - 1)
    before, least, after = (left[each, best + k] for k in (-1, 0, 1))
    curve = np.maximum(before - 2 * least + after, 1e-12)
    return best - ASIDE + np.clip(0.5 * (before - after) / curve, -1.0, 1.0), least


def _coded(light: Array) -> Array:
    return np.asarray(np.maximum(light, 0.0) ** (1 / GAMMA))


def granite_seen(slant: Array, disc: Stone) -> tuple[Array, Array]:
    """Say how much granite is seen beyond a cap, m: on slim shoulders and on full ones."""
    narrower = (disc.radius - disc.cap_radius) / (STONE.radius - STONE.cap_radius)
    return narrower * np.interp(slant, *SLIM), narrower * np.interp(slant, *FULL)


def by_light(seen: CapRays, disc: Stone) -> Array:
    """Say how much of a cap without hue is on rays about n places.

    Parameters
    ----------
    seen : CapRays
        What is seen there.
    disc : Stone
        Size of the stones.

    Returns
    -------
    ndarray, shape (n, rays, radii)
        0.5 on the cap, −0.5 on its granite, and on rays that look over the cap on whatever is
        beyond its edge.
    """
    light = light_of(seen.rays.bgr)
    on_cap, on_ring = light[..., : seen.of_cap.shape[-1]], light[..., seen.in_ring]
    cap, granite = (
        (part * use).sum((1, 2)) / np.maximum(use.sum((1, 2)), 1)
        for part, use in ((on_cap, seen.of_cap), (on_ring, seen.of_ring))
    )
    step = np.where(granite - cap > 1e-3, granite - cap, 1e-3)
    signal = np.asarray(0.5 - (light - cap[:, None, None]) / step[:, None, None])
    place, ray = np.nonzero(seen.behind > SLANT)
    along = seen.pixel_along(place, ray)
    at, told = _ends(seen, place, ray, along, granite[place], disc)
    blurs = (seen.rays.radius - at[told, None]) / (BLUR * along[told, None])
    signal[place[told], ray[told]] = 0.5 - past(blurs)
    return signal


def _ends(
    seen: CapRays,
    place: NDArray[np.intp],
    ray: NDArray[np.intp],
    along: Array,
    granite: Array,
    disc: Stone,
) -> tuple[Array, Flags]:
    """Find where the cap ends on each of m rays, m, and whether it does: by least squares.

    How full the granite's shoulders are is not known: each ray is fitted for all of `FULLNESS`,
    and the fits are averaged with the odds that the rays of a stone together give them.

    Parameters
    ----------
    seen : CapRays
    place, ray : ndarray of int, shape (m,)
        Which rays, ascending by place.
    along, granite : ndarray, shape (m,)
        How long a pixel is on each, m, and the light of the granite.
    disc : Stone
        Size of the stones.
    """
    light, inside = light_of(seen.over.bgr[place, ray]), seen.over.inside[place, ray]
    radii, radius = seen.rays.radius, seen.radius
    strips = granite_seen(seen.behind[place, ray], disc)
    step, each = float(radii[1] - radii[0]), np.arange(len(light))
    end = np.searchsorted(radii, radius + strips[1] + BEYOND * along).clip(max=len(radii) - 1)
    beyond = light[each, end]
    low, high = np.searchsorted(radii, np.array(INNER) * radius)
    cap = np.median(light[:, low:high], axis=1)
    steps = np.maximum(np.abs(_coded(np.stack([beyond, granite])) - _coded(cap)).max(0), 1e-3)
    used = inside & (radii > radius - WITHIN) & (radii < (radius + strips[1] + along)[:, None])
    codes = _coded(light)[:, None]
    beside = around(radii, radius)
    c, g, b = (part[:, None] for part in (cap, granite, beyond))
    blur = BLUR * along[:, None]
    at, misfit = [], []
    for full in FULLNESS:
        strip = (strips[0] + full * (strips[1] - strips[0]))[:, None]
        mixed = c + (g - c) * past(beside / blur) + (b - g) * past((beside - strip) / blur)
        samples, least = moved(_coded(mixed)[:, None], codes, used)
        at.append(radius + step * samples)
        misfit.append(least / steps**2)
    _, row = np.unique(place, return_inverse=True)
    square = np.stack([np.bincount(row, one) / np.bincount(row) for one in misfit])
    odds = SAMPLES * (square / np.maximum(square.min(0), 1e-6) - 1)
    odds += (((FULLNESS - USUAL_FULLNESS[0]) / USUAL_FULLNESS[1]) ** 2)[:, None]
    weight = np.exp(-0.5 * (odds - odds.min(0)))
    weight = (weight / weight.sum(0))[:, row]
    told = (weight * np.stack(misfit)).sum(0) < MISFIT**2
    return (weight * np.stack(at)).sum(0), np.asarray(told & inside[each, end])
