"""What the samples on rays about stones are, cap, granite or neither, and how they step."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import Appearance, membership
from curlshot.vision.detection.circles import medians
from curlshot.vision.detection.contrast import by_hue, mean_colours, own_worth
from curlshot.vision.detection.patch import (
    CAP_END,
    INNER_RING,
    OUTER_RING,
    RING_BEGIN,
    RING_END,
    Effort,
    in_granite,
    profile_of,
)
from curlshot.vision.detection.rays import Rays
from curlshot.vision.detection.rims import falls_along, summed

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]

CLEARLY = 0.3
"""Worth from which a sample counts as one of the cap; of the granite, less than its negative."""

DARK = 0.5
"""Lightness, as a share of that of the rest of a stone's granite, below which something covers it:
its own dark side has 0.8 of it, dark clothes 0.05 to 0.5. What is lighter may be ice behind a low
shoulder."""

SOME = 0.03
"""Share of the samples on a cap, and on granite, that show it at least where there is a stone."""


@dataclass(frozen=True)
class Samples:
    """Samples on the rays about n places of stones.

    Attributes
    ----------
    worth : ndarray, shape (n, rays, radii)
        What they may be: 1 cap, −1 granite, 0 neither.
    response : ndarray, shape (n,)
        How much they are as a stone's are: mean over the cap less mean over the granite.
    in_ring : slice
        Radii that lie on the granite.
    of_cap, of_ring : ndarray of bool, shape (n, rays, radii within)
        Which of those that lie on cap and granite show them without doubt.
    cap, granite : ndarray, shape (n, 3)
        Their mean colours, L*a*b*.
    apart : ndarray, shape (n, 3)
        Weights of L*a*b* by which the cap is 1 more than the granite.
    signal : ndarray, shape (n, rays, radii)
        Half for what is like the cap by these weights, −half for what is like the granite.
    falls : ndarray, shape (n, rays, radii, 3)
        How much the colours fall per step of the radius.
    capped, greyed : ndarray of bool, shape (n, rays)
        Rays that show the cap, and such as show granite.
    light, level : ndarray, shape (n, rays) and (n, 1)
        Lightness of the granite on each ray, and that of the most of them, L*.
    """

    worth: Floats
    response: Array
    in_ring: slice
    of_cap: Flags
    of_ring: Flags
    cap: Array
    granite: Array
    apart: Array
    signal: Floats
    falls: Floats
    capped: Flags
    greyed: Flags
    light: Array
    level: Array

    @property
    def stony(self) -> Flags:
        """Rays that show both."""
        return self.capped & self.greyed

    @property
    def along(self) -> Floats:
        """`apart`, to be multiplied with colours on rays, shape (n, 1, 3, 1)."""
        return self.apart.astype(np.float32)[:, None, :, None]

    @property
    def enough(self) -> Flags:
        """Places about which there is some cap and some granite, shape (n,)."""
        return np.asarray((self.of_cap.mean((1, 2)) > SOME) & (self.of_ring.mean((1, 2)) > SOME))


def samples_on(rays: Rays, appearance: Appearance, disc: Stone, effort: Effort) -> Samples:
    """Tell what the samples on rays about places of stones are."""
    lab = rays.lab.astype(np.float32)
    in_cap, in_ring = well_within(rays.radius, disc)
    template = _template(disc, effort)
    worth = _worth(rays, appearance, in_cap, in_ring, template)
    if not rays.inside.all():
        worth *= rays.inside
    of_cap, of_ring = worth[..., in_cap] > CLEARLY, worth[..., in_ring] < -CLEARLY
    cap = mean_colours(lab[..., in_cap, :], of_cap.astype(np.float32))
    granite = mean_colours(lab[..., in_ring, :], of_ring.astype(np.float32))
    apart = by_hue(cap, granite)
    half = ((granite * apart).sum(1) + 0.5).astype(np.float32)[:, None, None]
    signal = (lab @ apart.astype(np.float32)[:, None, :, None])[..., 0] - half
    seen_cap, seen_ring = rays.inside[..., in_cap], rays.inside[..., in_ring]
    capped = summed((signal[..., in_cap] > 0) & seen_cap) > 0.4 * np.maximum(summed(seen_cap), 1)
    stone_like = (worth[..., in_ring] < 0.1) & (signal[..., in_ring] < 0.05) & seen_ring
    in_view = np.maximum(summed(seen_ring), 1)
    light = summed(lab[..., in_ring, 0] * seen_ring) / in_view
    greyed = summed(stone_like) > 0.4 * in_view
    level = medians(light, capped & greyed)[:, None]
    return Samples(
        worth=worth,
        response=worth.mean(1) @ template,
        in_ring=in_ring,
        of_cap=of_cap,
        of_ring=of_ring,
        cap=cap,
        granite=granite,
        apart=apart,
        signal=signal,
        falls=falls_along(lab),
        capped=capped,
        greyed=greyed & (light > DARK * level),
        light=light,
        level=level,
    )


def well_within(radius: Array, disc: Stone) -> tuple[slice, slice]:
    """Tell which of the radii lie on a stone's cap, and which on its granite, not near an edge."""
    ends = [
        0.88 * disc.cap_radius,
        *(in_granite(disc, share) for share in (INNER_RING, OUTER_RING)),
    ]
    cap, first, last = np.searchsorted(radius, ends).tolist()
    return slice(0, cap), slice(first, last)


@lru_cache(maxsize=8)
def _template(disc: Stone, effort: Effort) -> Array:
    """Weights of the radii in the mean over the cap less the mean over the granite."""
    radius = profile_of(disc, effort).radius[: effort.radii]
    cap = radius * (radius < CAP_END * disc.cap_radius)
    first, last = (in_granite(disc, share) for share in (RING_BEGIN, RING_END))
    ring = radius * ((radius > first) & (radius < last))
    return np.asarray(cap / cap.sum() - ring / ring.sum())


def _worth(rays: Rays, appearance: Appearance, cap: slice, ring: slice, template: Array) -> Floats:
    """Say what samples may be by the colours that are known, their own, or what tells more."""
    table = appearance.membership
    if table is not None and not appearance.own:
        return membership(rays.bgr, table)
    granite = None if appearance.granite is None else appearance.granite.mean
    own = own_worth(rays.lab, cap, ring, granite)
    if table is None:
        return own
    known = membership(rays.bgr, table)
    more = (own - known).mean(1) @ template > 0
    return np.where(more[:, None, None], own, known)
