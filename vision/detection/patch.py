"""The patch of a picture in which a disc is measured: its rays, and how the camera sees it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE, Stone
from curlshot.vision.detection.rays import Look, Profile, Rays, chained, sample_rays, straight
from curlshot.vision.optics.cameras import Cameras

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]

HANDLE_HEIGHT = 0.15
"""How high above the ice the handle's grip is seen, m."""

HANDLE_HEIGHT_SD = 0.02
"""How far from the heights at which a cap is unrolled what turns on it is seen, m: grips are 3 to
5 cm above the cap, their feet and shades on it."""


@dataclass(frozen=True)
class Effort:
    """How a place is measured. Lengths are shares of the disc's radius.

    Attributes
    ----------
    rays, radii : int
        Samples of the polar patch around a place.
    inner, stone_outer, plain_outer : float
        Where the rays begin, and how far they reach: a stone's surroundings say nothing, a
        plain rim's do.
    handle_rings, handle_inner, handle_outer : int, float, float
        Rings of the picture by which the angle is told; the radii as shares of the cap's (or,
        of a plain disc, of its own).
    handle_edge : float
        Share of the cap's radius up to which it shows nothing of its edge.
    edge_reach : float
        Distance from the circle up to which an edge may count.
    most_tilt : float
        Tangent of the view's angle to the vertical at which the granite's outline counts half, and
        from which ice may be seen behind the far shoulder.
    rounds : int
        How often the edges are chosen about the circle that they gave.
    light : bool
        Whether the cap's centre is also measured by the lightness of its edge alone.
    coarse : float
        How far the edge of the cap may lie aside all around, px, beside what is usual, if its hue
        alone tells it.
    """

    rays: int = 48
    radii: int = 44
    inner: float = 0.20
    stone_outer: float = 1.06
    plain_outer: float = 1.3
    handle_rings: int = 8
    handle_inner: float = 0.12
    handle_outer: float = 0.86
    handle_edge: float = 0.94
    edge_reach: float = 0.035
    most_tilt: float = 0.15
    rounds: int = 2
    light: bool = True
    coarse: float = 0.0


EFFORT = Effort()


_GRANITE = STONE.radius - STONE.cap_radius

CAP_END = 0.94
RING_BEGIN, RING_END = 0.05 * STONE.cap_radius / _GRANITE, 1 - 0.04 * STONE.radius / _GRANITE
"""Up to where the template of a stone counts as cap, a share of the cap's radius, and between
which its ring of granite, shares of the way from the cap's edge to the stone's: edges are left
out."""

INNER_RING, OUTER_RING = 0.10 * STONE.cap_radius / _GRANITE, 1 - 0.03 * STONE.radius / _GRANITE
"""Between which granite is that nothing beside it blurs, the same shares."""

SHOULDER = 0.15 * STONE.cap_radius / _GRANITE
"""From where on the granite falls off, the same share."""


def in_granite(disc: Stone, share: float) -> float:
    """Radius at a share of the way from the edge of a stone's cap to its own, m."""
    return disc.cap_radius + share * (disc.radius - disc.cap_radius)


def is_plain(disc: Stone) -> bool:
    """Say whether a disc has no cap that could be told from its rim."""
    return disc.cap_radius <= 0


@lru_cache(maxsize=8)
def profile_of(disc: Stone, effort: Effort) -> Profile:
    """Give the samples of the stone's top, then two for each ring of the handle's picture."""
    inner = effort.inner * disc.radius
    if is_plain(disc):
        outer = effort.plain_outer * disc.radius
        top, grip = [(inner, 0.0), (outer, 0.0)], 0.0
    else:
        outer = effort.stone_outer * disc.radius
        edge, height = in_granite(disc, SHOULDER), disc.cap_height
        # The visible surface falls off towards the striking band, but not at the cap's edge:
        # away from a slanting view the rays would draw that edge out, and the circle fitted
        # to it would lie too near the camera.
        top = [
            (inner, height),
            (edge, height),
            (disc.radius, disc.rim_height),
            (outer, disc.rim_height),
        ]
        grip = HANDLE_HEIGHT
    low, high = _handle_span(disc, effort)
    rings = straight([(low, grip), (high, grip)], np.linspace(low, high, 2 * effort.handle_rings))
    return chained(straight(top, np.linspace(inner, outer, effort.radii)), rings)


def over_caps(looks: Sequence[Look], by: Cameras, rays: Rays, disc: Stone) -> Rays:
    """Give the same rays, but such as go on at the height of the cap and do not fall off.

    Parameters
    ----------
    looks : sequence of Look
        Pictures of one size and n places in all.
    by : Cameras
        Theirs (`curlshot.vision.detection.rays.cameras_of`).
    rays : Rays
        About these places, which fall off as the granite does (`profile_of`).
    disc : Stone
        Size of the discs.
    """
    first = int(np.searchsorted(rays.radius, in_granite(disc, SHOULDER)))
    past = rays.radius[first:]
    nodes = [(float(radius), disc.cap_height) for radius in past[[0, -1]]]
    level = sample_rays(looks, by, straight(nodes, past), len(rays.angle))
    bgr, lab, inside = (
        np.concatenate([falling[:, :, :first], flat], axis=2)
        for falling, flat in (
            (rays.bgr, level.bgr), (rays.lab, level.lab), (rays.inside, level.inside),
        )
    )  # fmt: skip
    return Rays(bgr, lab, inside, rays.radius, rays.angle)


@lru_cache(maxsize=8)
def handle_radii(disc: Stone, effort: Effort = EFFORT) -> Array:
    """Radii of the rings of the handle's picture, m, shape (rings,)."""
    rings = np.linspace(*_handle_span(disc, effort), 2 * effort.handle_rings)
    rings = rings.reshape(-1, 2).mean(1)
    rings.flags.writeable = False
    return np.asarray(rings)


def _handle_span(disc: Stone, effort: Effort) -> tuple[float, float]:
    """Radii between which the handle's picture is sampled, m."""
    size = disc.radius if is_plain(disc) else disc.cap_radius
    return effort.handle_inner * size, effort.handle_outer * size


def unrolled(looks: Sequence[Look], by: Cameras, disc: Stone, effort: Effort) -> tuple[Rays, Bytes]:
    """Sample what pictures show of discs at places.

    Parameters
    ----------
    looks : sequence of Look
        Pictures of one size and n places in all.
    by : Cameras
        Theirs (`curlshot.vision.detection.rays.cameras_of`).
    disc : Stone
        Size of the discs.
    effort : Effort

    Returns
    -------
    rays : Rays
        Where the edges are.
    handle : ndarray, shape (n, rays, rings, 3)
        What is around the centre, L*a*b*: at the height of the handle, 0 where it shows more
        than the cap, and beside it, for a stone, at the height of the cap.
    """
    sampled = sample_rays(looks, by, profile_of(disc, effort), effort.rays)
    count = effort.radii
    rays = Rays(
        sampled.bgr[:, :, :count],
        sampled.lab[:, :, :count],
        sampled.inside[:, :, :count],
        sampled.radius[:count],
        sampled.angle,
    )
    pairs = sampled.lab[:, :, count:]
    handle = np.asarray((pairs[:, :, ::2] >> 1) + (pairs[:, :, 1::2] >> 1))
    # A ring that leaves the picture tells no angle.
    handle *= np.all(sampled.inside[:, :, count + 1 :: 2], axis=1)[:, None, :, None]
    if is_plain(disc):
        return rays, handle
    # Behind the plane of the handle a slanting view shows the cap displaced. Rings that leave
    # it show its edge, which stays while the stone turns: they are blanked.
    tilt = np.hypot(*by.slants(np.concatenate([look.places for look in looks])).T)
    within = effort.handle_edge * disc.cap_radius - (HANDLE_HEIGHT - disc.cap_height) * tilt
    handle *= (sampled.radius[count + 1 :: 2] < within[:, None])[:, None, :, None]
    return rays, np.concatenate([handle, _rings(rays, handle_radii(disc, effort))], axis=2)


def _rings(rays: Rays, radii: Array) -> Bytes:
    """Give what the rays show on rings; 0 where these are not wholly in the picture."""
    outer = np.searchsorted(rays.radius, radii)
    seen = (rays.lab[:, :, outer - 1] >> 1) + (rays.lab[:, :, outer] >> 1)
    seen *= (np.all(rays.inside[:, :, outer], axis=1) & (outer > 0))[:, None, :, None]
    return np.asarray(seen)
