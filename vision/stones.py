"""Stones in one picture: found on the rectified ice by what a stone is, then measured.

A stone is a disc of grey granite with a saturated cap of known size, a known height above
the ice. A colour is worth +1 where it may be a cap, −1 where it may be granite and 0
elsewhere; the mean over the cap less the mean over the ring of granite around it is then 2
on a stone and 0 on anything of one colour, be it of the colour of a cap. What passes is
measured on rays from its centre in the picture itself.

Discs of which only the radius is known are found by the share of the gradient that points
along the radius (a structure tensor summed over the circle), of either sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import STONE, Stone
from vision.appearance import Appearance, any_stone, membership
from vision.camera import Camera
from vision.circles import Fit, Rays, Rim, falls_along, fit_circles, sample_rays, share_of_samples
from vision.clip import Image
from vision.ice_map import IceMap, rectify
from vision.sighting import Sighting

Array = NDArray[np.float64]
Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Search:
    """Where and how stones are sought.

    Attributes
    ----------
    x_max, y_min, y_max : float
        Stones are sought on |x| ≤ x_max, y_min ≤ y ≤ y_max, m.
    map_radius_px : float
        Radius of a disc on the rectified map, px.
    rays, radii : int
        Samples of the polar patch around a candidate.
    least_score : float
        Template response (0 to 2) from which a place is looked at.
    least_visible : float
        Share of the rays that must look like a stone.
    least_evidence, least_rim : float
        Least evidence for a stone (0 to about 3.5) and for a plain disc (0 to 1).
    edge_reach : float
        Distance from the circle, as a share of the radius, up to which an edge may count.
    most_tilt : float
        Tangent of the view's angle to the vertical at which the granite's outline counts half.
    rounds : int
        How often the edges are chosen about the circle that they gave.
    """

    x_max: float = 2.40
    y_min: float = -4.5
    y_max: float = 9.0
    map_radius_px: float = 11.6
    rays: int = 64
    radii: int = 60
    least_score: float = 0.45
    least_visible: float = 0.30
    least_evidence: float = 1.4
    least_rim: float = 0.6
    edge_reach: float = 0.035
    most_tilt: float = 0.15
    rounds: int = 2


SEARCH = Search()


STONE_REACH, PLAIN_REACH = 1.04, 1.3
"""How far the rays reach, in radii: a stone's surroundings say nothing, a plain rim's do."""


def plain_disc(radius: float) -> Stone:
    """Return a flat disc of which nothing but the radius is known."""
    return Stone(radius=radius, cap_radius=0.0, cap_height=0.0)


def is_plain(disc: Stone) -> bool:
    """Say whether a disc has no cap that could be told from its rim."""
    return disc.cap_radius <= 0


@lru_cache(maxsize=16)
def _annulus(inner: float, outer: float, size: int) -> Floats:
    """Weights of sum 1 over a ring, px, anti-aliased; shape (2 size + 1, 2 size + 1)."""
    fine = 6
    n = (2 * size + 1) * fine
    offset = (np.arange(n) - (n - 1) / 2) / fine
    r = np.hypot(*np.meshgrid(offset, offset))
    ring = ((r >= inner) & (r < outer)).astype(float)
    ring = ring.reshape(2 * size + 1, fine, 2 * size + 1, fine).mean((1, 3))
    return np.asarray(ring / ring.sum(), np.float32)


def _stone_response(ice: IceMap, appearance: Appearance, disc: Stone) -> Floats:
    worth = membership(ice.image, appearance) * ice.valid
    unit = ice.scale
    size = int(np.ceil(disc.radius * unit))
    kernel = _annulus(0.0, 0.94 * disc.cap_radius * unit, size) - _annulus(
        1.05 * disc.cap_radius * unit, 0.96 * disc.radius * unit, size
    )
    return np.asarray(
        cv2.filter2D(worth, cv2.CV_32F, kernel, borderType=cv2.BORDER_CONSTANT), np.float32
    )


def _disc_response(ice: IceMap, disc: Stone) -> Floats:
    """Share of the gradient near a circle that points along its radius, 0 to 2."""
    radius = disc.radius * ice.scale
    grey = cv2.GaussianBlur(ice.image, (0, 0), 0.8).astype(np.float32)
    gx = cv2.Sobel(grey, cv2.CV_32F, 1, 0, scale=1 / 8)
    gy = cv2.Sobel(grey, cv2.CV_32F, 0, 1, scale=1 / 8)
    inner = cv2.erode(ice.valid.astype(np.uint8), np.ones((5, 5), np.uint8))
    # Strong edges shall not outvote long ones: each pixel counts at most as much as a clear edge.
    energy = (gx**2 + gy**2).sum(2)
    weight = inner / (energy + 6.0**2)
    xx, xy, yy = ((u * v).sum(2) * weight for u, v in ((gx, gx), (gx, gy), (gy, gy)))
    size = int(np.ceil(radius + 2))
    ring = _annulus(radius - 1.3, radius + 1.3, size)
    offset = np.arange(-size, size + 1, dtype=np.float32)
    angle = np.arctan2(offset[:, None], offset[None, :])
    c, s = np.cos(angle), np.sin(angle)
    total = np.zeros(xx.shape, np.float32)
    # Radial energy counts for a circle, energy along the circle against it.
    for tensor, kernel in (
        (xx, ring * (c * c - s * s)), (xy, ring * 4 * c * s), (yy, ring * (s * s - c * c)),
    ):  # fmt: skip
        total += cv2.filter2D(tensor, cv2.CV_32F, kernel, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(2 * total, np.float32)


def _far_apart(
    places: NDArray[np.intp], order: NDArray[np.intp], spacing: float
) -> NDArray[np.intp]:
    """Those of the places, in this order, that are not nearer to one before than `spacing`."""
    kept: list[int] = []
    for index in order.tolist():
        if not kept or np.hypot(*(places[kept] - places[index]).T).min() >= spacing:
            kept.append(index)
    return np.array(kept, np.intp)


def _peaks(response: Floats, least: float, spacing_px: float, most: int = 60) -> Array:
    """Local maxima, strongest first: row, column (to a fraction) and height, shape (n, 3)."""
    reach = 2 * int(0.5 * spacing_px) + 1
    shape = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    smooth = cv2.GaussianBlur(response, (0, 0), 0.7)
    top = (smooth >= cv2.dilate(smooth, shape)) & (smooth > least)
    top[[0, -1]] = top[:, [0, -1]] = False
    row, column = np.nonzero(top)
    height = smooth[row, column].astype(float)
    order = _far_apart(np.stack([row, column], 1), np.argsort(-height), spacing_px)[:most]
    row, column, height = row[order], column[order], height[order]
    shifts = []
    for before, after in (
        (smooth[row - 1, column], smooth[row + 1, column]),
        (smooth[row, column - 1], smooth[row, column + 1]),
    ):
        bend = 2 * height - before - after
        shifts.append(np.where(bend > 1e-6, 0.5 * (after - before) / np.maximum(bend, 1e-6), 0.0))
    return np.stack([row + shifts[0], column + shifts[1], height], 1)


@dataclass(frozen=True)
class _Measured:
    fit: Fit
    colour: Array
    visible: float
    evidence: float
    cap_samples: Array
    granite_samples: Array


def _mean_along(values: Array, use: NDArray[np.bool_]) -> Array:
    """Mean over the chosen samples of each ray; 0 where there are none."""
    return np.asarray((values * use).sum(1) / np.maximum(use.sum(1), 1))


def _measure_stone(
    rays: Rays,
    index: int,
    appearance: Appearance,
    disc: Stone,
    search: Search,
    noise: float,
    tilt: float,
) -> _Measured | None:
    """Fit the edges of cap and granite; None where there are none."""
    lab, inside, radius = rays.lab[index].astype(float), rays.inside[index], rays.radius
    falls = falls_along(rays.lab[index])
    in_cap = (radius > 0.15 * disc.cap_radius) & (radius < 0.88 * disc.cap_radius)
    in_ring = (radius > 1.10 * disc.cap_radius) & (radius < 0.97 * disc.radius)
    worth = membership(rays.bgr[index], appearance)
    cap_pixels = lab[:, in_cap][inside[:, in_cap] & (worth[:, in_cap] > 0.3)]
    ring_pixels = lab[:, in_ring][inside[:, in_ring] & (worth[:, in_ring] < -0.3)]
    if len(cap_pixels) < 60 or len(ring_pixels) < 30:
        return None
    cap, granite = np.median(cap_pixels, axis=0), np.median(ring_pixels, axis=0)
    # Bolts and highlights are light and dark alike; the hue is what ends at the cap's edge.
    apart = np.array([0.1, 1.0, 1.0]) * (cap - granite)
    apart = apart / float((cap - granite) @ apart)
    signal = (lab - granite) @ apart
    capped = share_of_samples(signal[:, in_cap] > 0.5, inside[:, in_cap]) > 0.4
    greyed = (
        share_of_samples(
            (worth[:, in_ring] < 0.1) & (signal[:, in_ring] < 0.55), inside[:, in_ring]
        )
        > 0.4
    )
    cap_radius, rim_radius = np.array([disc.cap_radius, disc.radius]) * appearance.outline
    stony = capped & greyed
    if stony.mean() < search.least_visible:
        return None
    at_cap, at_rim = rays.at(index, cap_radius), rays.at(index, rim_radius)
    cap_rim = Rim(falls @ apart, stony, at_cap, cap_radius, 0.12 * cap_radius, 0.3)
    edges = np.sqrt((falls**2).sum(-1))
    # Seen aslant, the granite's outline is not a circle of one height.
    trust = 1 / (1 + (tilt / search.most_tilt) ** 2)
    granite_rim = Rim(edges, greyed, at_rim, rim_radius, 0.05 * rim_radius, 12.0, trust)
    fit = fit_circles(
        rays,
        index,
        (cap_rim, granite_rim),
        appearance.slack,
        search.edge_reach,
        noise,
        search.rounds,
    )
    if fit is None:
        return None
    # All around, a stone's granite is of one lightness, and its cap is as large as any other's;
    # caps and shoulders of people are neither.
    light = _mean_along(lab[..., 0], inside & in_ring)[stony]
    uneven = float(np.std(light)) / 40 if len(light) else 1.0
    misfit = float((fit.radii[0] / cap_radius - 1) / (0.06 + appearance.slack)) ** 2
    visible = float(np.mean(stony & at_cap))
    clear = float(fit.shares.sum()) + 0.5 * visible / max(float(at_cap.mean()), 0.3)
    evidence = clear - uneven - 0.5 * misfit
    return _Measured(fit, cap, visible, evidence, cap_pixels[::7], ring_pixels[::5])


def _measure_disc(
    rays: Rays, index: int, disc: Stone, search: Search, noise: float
) -> _Measured | None:
    """Fit the rim of a disc of unknown colours; None where there is no such circle."""
    lab, inside, radius = rays.lab[index], rays.inside[index], rays.radius
    steps = np.sqrt((falls_along(lab) ** 2).sum(-1))
    at_rim = rays.at(index, disc.radius)
    rim = Rim(steps, at_rim, at_rim, disc.radius, 0.06 * disc.radius, 12.0)
    fit = fit_circles(rays, index, (rim,), 0.03, search.edge_reach, noise, search.rounds)
    if fit is None:
        return None
    within = radius < 0.8 * disc.radius
    inner = lab[:, within][inside[:, within]]
    seen = float(fit.shares[0] * at_rim.mean())
    none = np.empty((0, 3))
    return _Measured(fit, np.median(inner, axis=0), seen, float(fit.shares[0]), none, none)


def find_stones(
    image: Image,
    camera: Camera,
    appearance: Appearance | None = None,
    disc: Stone = STONE,
    search: Search = SEARCH,
) -> tuple[Sighting, ...]:
    """Find and measure the stones in one picture.

    Parameters
    ----------
    image : ndarray, shape (h, w, 3)
        BGR.
    camera : Camera
        The picture's camera; where its position is known, the height of the cap is taken out.
    appearance : Appearance, optional
        What stones look like here, from `learn`; without it, what any stone looks like.
    disc : Stone
        Radius, cap radius and cap height; `plain_disc` for a disc without a cap.

    Returns
    -------
    tuple of Sighting
        Strongest first; no two nearer than discs can be.
    """
    ice = rectify(
        image,
        camera,
        _bounds(camera, disc, search),
        scale=search.map_radius_px / disc.radius,
        height=disc.cap_height,
    )
    if ice is None or not ice.valid.any():
        return ()
    plain = is_plain(disc)
    if not plain and appearance is None:
        light = cv2.cvtColor(ice.image, cv2.COLOR_BGR2LAB)[..., 0]
        appearance = any_stone(max(float(np.percentile(light[ice.valid], 75)), 60.0))
    if appearance is None:
        response = _disc_response(ice, disc)
    else:
        response = _stone_response(ice, appearance, disc)
    spacing = 1.8 * disc.radius * ice.scale
    peaks = _peaks(response, search.least_score, spacing)
    if not len(peaks):
        return ()
    places, scores = ice.place(peaks[:, 1], peaks[:, 0]), peaks[:, 2]
    found: list[Sighting] = []
    # The second time from the centre that the first has found, roughly.
    for effort in (replace(search, rounds=1), search):
        rays = sample_rays(image, camera, places, *_profile(disc, search), search.rays)
        found, kept = [], []
        for index, (place, score) in enumerate(zip(places, scores, strict=True)):
            sighting = _measure(rays, index, place, float(score), camera, appearance, disc, effort)
            if sighting is not None:
                found.append(sighting)
                kept.append(index)
        if not found:
            return ()
        places, scores = np.array([(item.x, item.y) for item in found]), scores[kept]
    return _apart(found, disc, search)


def _bounds(camera: Camera, disc: Stone, search: Search) -> tuple[float, float, float, float]:
    """Part of the ice on which to look: x0, x1, y0, y1, m."""
    if not is_plain(disc):
        return -search.x_max, search.x_max, search.y_min, search.y_max
    width, height = camera.size
    corners = camera.ice(np.array([[0, 0], [width, 0], [0, height], [width, height]], float))
    (x0, y0), (x1, y1) = corners.min(0).tolist(), corners.max(0).tolist()
    return x0, x1, y0, y1


def _profile(disc: Stone, search: Search) -> tuple[Array, Array]:
    """Radii of the samples and the height of what is seen there, m."""
    reach = PLAIN_REACH if is_plain(disc) else STONE_REACH
    radius = np.linspace(0.03, reach, search.radii) * disc.radius
    # Outside the cap the visible surface falls off towards the striking band at half height.
    height = np.interp(
        radius, [1.03 * disc.cap_radius, disc.radius], [disc.cap_height, 0.5 * disc.cap_height]
    )
    return radius, height


def _measure(
    rays: Rays,
    index: int,
    place: Array,
    score: float,
    camera: Camera,
    appearance: Appearance | None,
    disc: Stone,
    search: Search,
) -> Sighting | None:
    pixel = 1 / camera.scale_at(place)
    noise, tilt = 0.25 * pixel, _tilt(camera, place)
    if appearance is None:
        seen = _measure_disc(rays, index, disc, search, noise)
        expected, least = disc.radius, search.least_rim
    else:
        seen = _measure_stone(rays, index, appearance, disc, search, noise, tilt)
        expected, least = disc.cap_radius, search.least_evidence
    if seen is None:
        return None
    evidence = seen.evidence if appearance is None else seen.evidence + 0.5 * score
    if (
        evidence < least
        or seen.visible < search.least_visible
        or float(np.hypot(*seen.fit.shift)) > 0.35 * expected
    ):
        return None
    x, y = place + seen.fit.shift
    if not is_plain(disc) and abs(x) > search.x_max - 0.4 * disc.radius:
        return None
    # What displaces the edges of one side is made good by the other side, if that is seen.
    hidden = 0.0 if is_plain(disc) else 0.04 * disc.radius * (1 - seen.visible)
    sd = np.sqrt(np.diag(seen.fit.covariance) + (0.1 * pixel) ** 2 + hidden**2)
    return Sighting(
        float(x),
        float(y),
        float(sd[0]),
        float(sd[1]),
        _shared_error(camera, (x, y), tilt, pixel, disc),
        seen.colour,
        seen.visible,
        evidence,
        tuple(
            seen.fit.radii
            / ([disc.radius] if appearance is None else [disc.cap_radius, disc.radius])
        ),
        rays.lab[index],
        seen.cap_samples,
        seen.granite_samples,
    )


def _tilt(camera: Camera, place: Array) -> float:
    """Tangent of the angle between the view of a place and the vertical; 0 where unknown."""
    if camera.position is None or not np.isfinite(camera.position).all():
        return 0.0
    return float(np.hypot(*(place - camera.position[:2])) / camera.position[2])


def _shared_error(
    camera: Camera, place: tuple[float, float], tilt: float, pixel: float, disc: Stone
) -> float:
    """Give the standard error that no filter averages out, m: camera, cap's edge and height."""
    rms = camera.rms_px if np.isfinite(camera.rms_px) else 0.3
    edge = 0.0 if is_plain(disc) else 0.010 * disc.radius
    aslant = 0.04 * disc.cap_height * tilt
    parts = [0.35 * rms * pixel, edge, aslant, float(camera.place_sd(place))]
    return float(np.linalg.norm(parts))


def _apart(found: Sequence[Sighting], disc: Stone, search: Search) -> tuple[Sighting, ...]:
    """Keep the better of any two that overlap more than two discs can."""
    kept: list[Sighting] = []
    for item in sorted(found, key=lambda s: -s.score):
        if all(np.hypot(item.x - k.x, item.y - k.y) > 1.6 * disc.radius for k in kept):
            kept.append(item)
    return tuple(kept)
