"""The middle of a cap that moves while its picture is taken.

Its edges across the motion are then ramps as long as its way: at 3 m/s half as wide as the cap.
Where such a ramp falls most steeply is chance. How far it has come on either side of the middle is
not: for so much of the exposure the cap covered the place, and that is known in closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, nan

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.circles import medians
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.rays import Rays, directions

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]

SWEPT = 0.06, 0.08
"""How far a stone moves across the picture, from one to the next, m of the ice, from where on and
up to where the middle of what it covered takes the place of that of its edges: they are smeared by
about half of it."""

SHORT = 0.022, 0.035
"""Ways of a cap as they are made out, m, up to which it may be as sharp as one at rest, and from
which on it is not: the exposure may be short, or the camera may follow the stone."""

EXPOSED, UNSURE = 0.5, 0.5
"""Share of the time from one picture to the next for which film is exposed as a rule, and how far
from that, as a share of it, it may be."""

OFF, BY_EDGES_OFF = 0.02, 0.1
"""How far that middle is off along the way, as a share of it, and how far that of smeared edges is,
as a share of how far the stone moves from picture to picture: as clips with truth show."""

FARTHEST = 0.3
"""How far from where it is looked for the middle may be, in cap radii."""

LEVELS_SD = 0.1
"""How far the levels of cap and granite may be from those of their samples, steps between them."""

ALIKE = 20.0
"""Samples whose errors are alike."""

CLIPPED = 0.9
"""Beyond this, steps from half way, colours are those of something else."""

SCATTER, FAR = 0.03, 4.7
"""Least scatter of samples, steps; and at how many times their scatter they say nothing."""

SHARPEST = 0.016
"""Width of the sharpest edges, m: pixels and lenses blur them."""

LONGEST_STEP, LONGEST = 0.02, 1.5
"""Longest step of the fit, m, and longest way of a cap, in its radii."""

FEWEST = 60
"""Samples that tell a middle."""

SIZE = 5
"""Unknowns: where the middle is, how long the way, gain and offset of the colours."""

ROUNDS = 5


def swept_share(drift: Array) -> Array:
    """Tell what the middle of what a cap covered counts beside that of its edges, shape (n,).

    Parameters
    ----------
    drift : ndarray, shape (n, 2)
        How far the stones move across the picture, from one to the next, m of the ice.
    """
    low, high = SWEPT
    return np.asarray(np.clip((np.hypot(*drift.T) - low) / (high - low), 0.0, 1.0))


def widened(times: Sequence[float], seen: Sequence[Detection]) -> list[Detection]:
    """State of the detections of one stone how smeared edges err, where these tell its place.

    How fast a stone goes is not known where it is first seen, or just after a hit; and of one that
    is covered or leaves the picture only the edges tell.

    Parameters
    ----------
    times : sequence of float
        Ascending, s.
    seen : sequence of Detection
        The stone at these times.
    """
    out = list(seen)
    if len(out) < 2:
        return out
    step = float(np.median(np.diff(times)))
    places = np.array([(detection.x, detection.y) for detection in seen])
    drift = step * np.gradient(places, np.array(times), axis=0)
    share = swept_share(drift)
    for k in np.flatnonzero(share > 0).tolist():
        if not out[k].swept:
            x, y = (BY_EDGES_OFF * share[k] * np.abs(drift[k])).tolist()
            sd_x, sd_y = hypot(out[k].sd_x, x), hypot(out[k].sd_y, y)
            out[k] = out[k]._replace(sd_x=sd_x, sd_y=sd_y, light=(nan, nan))
    return out


def middles(
    signal: Floats, rays: Rays, disc: Stone, by_edges: Array, drift: Array
) -> tuple[Flags, Array, Array]:
    """Find the middles of smeared caps.

    Only what the stone covered all the time is looked at: what lies beyond is ice or paint for a
    part of it.

    Parameters
    ----------
    signal : ndarray, shape (n, rays, radii)
        From the granite (about −0.5) to the cap (about 0.5).
    rays : Rays
        About n places near the middles.
    disc : Stone
    by_edges : ndarray, shape (n, 2)
        Where the middles are by the caps' edges, off the places, m.
    drift : ndarray, shape (n, 2)
        How far the stones move across the picture, from one to the next, m of the ice; more than 0.

    Returns
    -------
    ok : ndarray of bool, shape (n,)
        Whether it was found how far the cap is smeared.
    middle : ndarray, shape (n, 2)
        Off the places, m; that by the edges as far as these say more.
    off : ndarray, shape (n, 2)
        Standard errors beyond those by the edges, m; 0 where the edges say it all.
    """
    length = np.hypot(*drift.T)
    along = drift / length[:, None]
    used, middle, way = _fitted(signal, rays, disc, along, EXPOSED * length)
    ok = (used > FEWEST) & (np.hypot(*middle.T) < FARTHEST * disc.cap_radius)
    share = ok * swept_share(drift) * np.clip((way - SHORT[0]) / (SHORT[1] - SHORT[0]), 0.0, 1.0)
    off = (OFF * share * way)[:, None] * np.abs(along)
    return ok, by_edges + share[:, None] * (middle - by_edges), off


def _fitted(
    signal: Floats, rays: Rays, disc: Stone, along: Array, usual: Array
) -> tuple[NDArray[np.int_], Array, Array]:
    """Fit what caps cover on their ways: samples that tell it, middles, (n, 2), and ways, m.

    By least squares, robust by reweighting (Tukey's biweight).

    Parameters
    ----------
    along : ndarray, shape (n, 2)
        Unit vectors along the ways.
    usual : ndarray, shape (n,)
        How long the ways are as a rule, m.
    """
    n, every = len(signal), slice(None, None, 2)
    radius, around = rays.radius[every], directions(len(rays.angle))[1][every]
    points = (around[:, None] * radius[:, None]).reshape(-1, 2)
    seen = np.clip(signal[:, every, every], -CLIPPED, CLIPPED).reshape(n, -1).astype(float)
    shown = rays.inside[:, every, every].reshape(n, -1)
    area = np.tile(radius, len(around)) / disc.cap_radius
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    middle, way, used = np.zeros((n, 2)), usual.copy(), shown
    for _ in range(ROUNDS):
        off = points - middle[:, None]
        a, b = (off @ along[..., None])[..., 0], (off @ across[..., None])[..., 0]
        chord = np.sqrt(np.maximum(disc.radius**2 - b**2, 0.0))
        used = shown & (np.abs(a) + 0.5 * way[:, None] < chord)
        share, change = _covered(a, b, way[:, None], disc.cap_radius)
        left = seen - (share - 0.5)
        scatter = 1.4826 * medians(np.abs(left), used) + SCATTER
        weight = used * area * np.maximum(1 - (left / (FAR * scatter[:, None])) ** 2, 0.0) ** 2
        design = np.stack([*change, share - 0.5, np.ones_like(share)], axis=-1)
        held = np.full((n, SIZE), 1e-9)
        held[:, 2] = ALIKE * (scatter / (UNSURE * usual)) ** 2
        held[:, 3:] = ALIKE * (scatter[:, None] / LEVELS_SD) ** 2
        pull = ((weight * left)[:, None] @ design)[:, 0]
        pull[:, 2] -= held[:, 2] * (way - usual)
        normal = np.swapaxes(design * weight[..., None], 1, 2) @ design
        normal[:, range(SIZE), range(SIZE)] += held
        step = np.linalg.solve(normal, pull[..., None])[:, :3, 0]
        step = np.clip(step, -LONGEST_STEP, LONGEST_STEP)
        middle = middle + step[:, :1] * along + step[:, 1:2] * across
        way = np.clip(way + step[:, 2], 0.1 * usual, LONGEST * disc.cap_radius)
    return used.sum(1), middle, way


def _covered(
    a: Array, b: Array, way: Array, radius: float
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Share of the exposure for which a moving disc covers places.

    Parameters
    ----------
    a, b : ndarray
        Where they are from its middle, along its way and across it, m.
    way : ndarray
        How far it moves, m.
    radius : float
        m.

    Returns
    -------
    share : ndarray
    change : tuple of ndarray
        Of the share by the middle, along and across, and by the way, 1/m.
    """
    half = np.sqrt(np.maximum(radius**2 - b**2, (0.01 * radius) ** 2))
    enters, leaves = a - half > -0.5 * way, a + half < 0.5 * way
    first, last = np.where(enters, a - half, -0.5 * way), np.where(leaves, a + half, 0.5 * way)
    some = (last > first) & (np.abs(b) < radius)
    share = np.where(some, last - first, 0.0) / way
    by_a = np.where(some, leaves * 1.0 - enters, 0.0) / way
    by_b = np.where(some, -b / half * (leaves * 1.0 + enters), 0.0) / way
    by_b = np.clip(by_b, -1 / SHARPEST, 1 / SHARPEST)
    by_way = np.where(some, 0.5 * (~leaves * 1.0 + ~enters), 0.0) / way - share / way
    return share, (-by_a, -by_b, by_way)
