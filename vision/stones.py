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
from dataclasses import dataclass, field
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import STONE, Stone
from vision.camera import Camera
from vision.clip import Image

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
    """

    x_max: float = 2.40
    y_min: float = -3.0
    y_max: float = 7.5
    map_radius_px: float = 11.6
    rays: int = 64
    radii: int = 60
    least_score: float = 0.55
    least_visible: float = 0.30
    least_evidence: float = 1.6
    least_rim: float = 0.6
    edge_reach: float = 0.035


SEARCH = Search()


@dataclass(frozen=True)
class Colour:
    """A colour in CIE L*a*b* (8-bit scaling of OpenCV): mean and covariance."""

    mean: Array
    covariance: Array

    def distance2(self, lab: Array) -> Array:
        """Squared Mahalanobis distance of colours, shape (..., 3)."""
        away = lab - self.mean
        return np.asarray(
            np.einsum("...i,ij,...j->...", away, np.linalg.inv(self.covariance), away)
        )

    @property
    def bgr(self) -> tuple[int, int, int]:
        """The mean colour as blue, green, red of 0 to 255."""
        return lab_to_bgr(self.mean)


@dataclass(frozen=True)
class Appearance:
    """What stones look like in a clip.

    Attributes
    ----------
    membership : ndarray, shape (64, 64, 64)
        For a colour (blue, green, red in steps of 4): 1 cap, −1 granite, 0 neither.
    caps : tuple of Colour
        The cap colours of the clip; empty where they are not known yet.
    granite : Colour or None
        The colour of the granite.
    outline : tuple of float
        Radii at which cap and granite are seen to end, as shares of the nominal ones.
    slack : float
        Standard deviation of a stone's radii about these, as a share.
    """

    membership: Floats
    caps: tuple[Colour, ...] = ()
    granite: Colour | None = None
    outline: tuple[float, float] = (1.0, 0.98)
    slack: float = 0.03


@dataclass(frozen=True)
class Sighting:
    """One stone seen in one picture.

    Attributes
    ----------
    x, y, sd_x, sd_y : float
        Place on the ice under its centre and its standard error, m.
    colour : ndarray, shape (3,)
        Colour of the cap, L*a*b*.
    visible : float
        Share of the circle that was seen, 0 to 1.
    score : float
        Evidence that it is a stone: 1.5 is little, 3 is much.
    outline : tuple of float
        Radii found for cap and granite (or the rim alone), as shares of the nominal ones.
    patch : ndarray, shape (rays, radii, 3)
        L*a*b* on rays from the centre, counter-clockwise from the x axis of the ice, out to
        1.04 radii.
    cap_samples, granite_samples : ndarray, shape (n, 3)
        Colours of the cap and of the granite, for learning.
    spectrum : ndarray or None
        What is kept of the patch to measure the angle (`vision.handle.cap_spectrum`).
    """

    x: float
    y: float
    sd_x: float
    sd_y: float
    colour: Array
    visible: float
    score: float
    outline: tuple[float, ...] = field(repr=False)
    patch: NDArray[np.uint8] = field(repr=False)
    cap_samples: Array = field(repr=False, default_factory=lambda: np.empty((0, 3)))
    granite_samples: Array = field(repr=False, default_factory=lambda: np.empty((0, 3)))
    spectrum: NDArray[np.complex64] | None = field(repr=False, default=None)


def lab_to_bgr(lab: Array) -> tuple[int, int, int]:
    """Blue, green, red of 0 to 255 from a colour in L*a*b*."""
    pixel = np.clip(lab, 0, 255).astype(np.uint8).reshape(1, 1, 3)
    blue, green, red = cv2.cvtColor(pixel, cv2.COLOR_LAB2BGR).ravel().tolist()
    return int(blue), int(green), int(red)


def plain_disc(radius: float) -> Stone:
    """Return a flat disc of which nothing but the radius is known."""
    return Stone(radius=radius, cap_radius=0.0, cap_height=0.0)


def is_plain(disc: Stone) -> bool:
    """Say whether a disc has no cap that could be told from its rim."""
    return disc.cap_radius <= 0


# --- the rectified ice -----------------------------------------------------------------


@dataclass(frozen=True)
class IceMap:
    """The ice as seen from straight above, at the height of the caps.

    Attributes
    ----------
    image : ndarray, shape (h, w, 3)
        BGR.
    valid : ndarray of bool, shape (h, w)
        Where the picture shows the ice.
    left, top : float
        Ice place of the middle of the pixel (0, 0), m.
    scale : float
        Pixels per metre.
    """

    image: Image
    valid: NDArray[np.bool_]
    left: float
    top: float
    scale: float

    def place(self, column: Array, row: Array) -> Array:
        """Ice place (x, y) of map pixels, shape (..., 2)."""
        return np.stack([self.left + column / self.scale, self.top - row / self.scale], -1)


def lifted(camera: Camera, ice: Array, height: Array | float) -> Array:
    """Ice points hidden behind points (x, y), shape (..., 2), that are `height` above the ice."""
    if camera.position is None or not np.isfinite(camera.position).all():
        return ice
    rise = np.asarray(height, float)[..., None]
    return np.asarray(ice + (ice - camera.position[:2]) * rise / (camera.position[2] - rise))


def rectify(image: Image, camera: Camera, disc: Stone, search: Search = SEARCH) -> IceMap | None:
    """Map the part of the picture that shows the sheet onto the ice; None where it shows none."""
    width, height = camera.size
    scale = search.map_radius_px / disc.radius
    cell = 8  # map pixels between the nodes at which the camera is evaluated
    if is_plain(disc):
        corners = camera.ice(np.array([[0, 0], [width, 0], [0, height], [width, height]], float))
        (x0, y0), (x1, y1) = corners.min(0), corners.max(0)
    else:
        x0, x1, y0, y1 = -search.x_max, search.x_max, search.y_min, search.y_max
    xs = np.arange(x0, x1 + cell / scale, cell / scale)
    ys = np.arange(y1, y0 - cell / scale, -cell / scale)
    ice = np.stack(np.meshgrid(xs, ys), -1)
    ground = lifted(camera, ice, disc.cap_height)
    depth = ground @ camera.homography[2, :2] + camera.homography[2, 2]
    nodes = np.full(ground.shape, -1e4)
    nodes[depth > 0.05] = camera.project(ground[depth > 0.05])
    inside = np.all((nodes > -0.5) & (nodes < np.array([width, height]) - 0.5), axis=-1)
    rows, columns = np.flatnonzero(np.any(inside, 1)), np.flatnonzero(np.any(inside, 0))
    if len(rows) < 2 or len(columns) < 2:
        return None
    top, bottom = max(rows[0] - 1, 0), min(rows[-1] + 2, len(ys))
    left, right = max(columns[0] - 1, 0), min(columns[-1] + 2, len(xs))
    part = np.asarray(nodes[top:bottom, left:right], np.float32)
    shape = ((bottom - top - 1) * cell, (right - left - 1) * cell)
    column, row = np.meshgrid(
        np.arange(shape[1], dtype=np.float32) / cell, np.arange(shape[0], dtype=np.float32) / cell
    )
    pixels = np.asarray(cv2.remap(part, column, row, cv2.INTER_LINEAR), np.float32)
    # A picture much finer than the map is averaged first, else the map would be grainy.
    fine = np.sqrt(inside.sum()) * cell
    coarser = max(1, int(0.8 * np.sqrt(_visible_area(part, width, height)) / fine))
    if coarser > 1:
        small = (width // coarser, height // coarser)
        image = np.asarray(cv2.resize(image, small, interpolation=cv2.INTER_AREA), np.uint8)
        pixels = np.asarray((pixels + 0.5) / coarser - 0.5, np.float32)
    ice_image = cv2.remap(
        image, pixels[..., 0], pixels[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT
    )
    limit = np.array([image.shape[1], image.shape[0]]) - 1
    valid = np.all((pixels >= 0) & (pixels <= limit), axis=-1)
    return IceMap(
        np.asarray(ice_image, np.uint8), valid, float(xs[left]), float(ys[top]), float(scale)
    )


def _visible_area(nodes: Floats, width: int, height: int) -> float:
    """Pixels of the picture that the nodes' hull covers, at most all of them."""
    low = np.clip(nodes.min((0, 1)), 0, [width, height])
    high = np.clip(nodes.max((0, 1)), 0, [width, height])
    return float(np.prod(np.maximum(high - low, 1)))


# --- what a colour says ----------------------------------------------------------------


@lru_cache(maxsize=1)
def _lab_of_table() -> Array:
    steps = (np.arange(64) * 4 + 2).astype(np.uint8)
    bgr = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), -1).reshape(64, -1, 3)
    lab = cv2.cvtColor(bgr, cv2.COLOR_BGR2LAB).reshape(64, 64, 64, 3)
    return np.asarray(lab, float)


def any_stone(white: float = 210.0) -> Appearance:
    """Appearance of stones before any is known: saturated caps, grey granite darker than ice.

    Parameters
    ----------
    white : float
        Lightness L* of the white ice in the picture, 0 to 255.
    """
    lab = _lab_of_table()
    chroma = np.hypot(lab[..., 1] - 128, lab[..., 2] - 128)
    light = lab[..., 0] / white
    cap = np.clip((chroma - 28) / 14, 0, 1)
    granite = (
        np.clip((36 - chroma) / 16, 0, 1)
        * np.clip((light - 0.08) / 0.1, 0, 1)
        * np.clip((0.78 - light) / 0.1, 0, 1)
    )
    return Appearance((cap - granite).astype(np.float32))


def learn(sightings: Sequence[Sighting], most_colours: int = 2) -> Appearance | None:
    """Learn the cap colours and the granite of a clip from sightings in many frames.

    Caps are grouped by their colour; groups that are rare beside the others are left out.

    Returns
    -------
    Appearance or None
        None where there are no sightings.
    """
    groups: list[list[Sighting]] = []
    for sighting in sorted(sightings, key=lambda item: -item.score):
        for group in groups:
            if colour_difference(group[0].colour, sighting.colour) < 30:
                group.append(sighting)
                break
        else:
            groups.append([sighting])
    groups.sort(key=len, reverse=True)
    groups = [group for group in groups[:most_colours] if len(group) >= 0.08 * len(groups[0])]
    if not groups:
        return None
    caps = tuple(
        _colour(np.concatenate([s.cap_samples for s in group]), (18.0, 6.0, 6.0))
        for group in groups
    )
    granite = _colour(
        np.concatenate([s.granite_samples for group in groups for s in group]), (15.0, 9.0, 9.0)
    )
    lab = _lab_of_table()
    distances = [np.sqrt(cap.distance2(lab)) for cap in caps]
    cap = np.clip((4.5 - np.min(distances, axis=0)) / 1.5, 0, 1)
    grey = np.clip((4.0 - np.sqrt(granite.distance2(lab))) / 1.5, 0, 1)
    chosen = [s.outline for group in groups for s in group if s.visible > 0.8]
    if len(chosen) < 3:
        return Appearance((cap - grey).astype(np.float32), caps, granite)
    cap_share, rim_share = np.median(np.array(chosen), axis=0).tolist()
    return Appearance((cap - grey).astype(np.float32), caps, granite, (cap_share, rim_share), 0.01)


def colour_difference(first: Array, second: Array) -> float:
    """Difference of two cap colours, mostly of hue: lightness changes with the lamps."""
    away = np.asarray(first, float) - np.asarray(second, float)
    return float(np.sqrt(0.1 * away[0] ** 2 + away[1] ** 2 + away[2] ** 2))


def _colour(samples: Array, floor: tuple[float, float, float]) -> Colour:
    centre = np.median(samples, axis=0)
    near = samples[(np.abs(samples - centre) < 4 * np.array(floor)).all(1)]
    spread = np.cov(near.T) if len(near) > 10 else np.zeros((3, 3))
    return Colour(centre, spread + np.diag(np.square(floor)))


def membership(image: Image, appearance: Appearance) -> Floats:
    """Say what each pixel may be: 1 cap, −1 granite, 0 neither; shape (h, w)."""
    b, g, r = (image[..., channel].astype(np.int32) >> 2 for channel in range(3))
    return np.asarray(appearance.membership.ravel().take((b << 12) | (g << 6) | r), np.float32)


# --- candidates ------------------------------------------------------------------------


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


def _peaks(response: Floats, least: float, spacing_px: float, most: int = 60) -> NDArray[np.intp]:
    """Rows and columns of local maxima, strongest first, shape (n, 2)."""
    reach = 2 * int(spacing_px / 2) + 1
    shape = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    smooth = cv2.GaussianBlur(response, (0, 0), 0.7)
    top = (smooth >= cv2.dilate(smooth, shape)) & (smooth > least)
    found = np.argwhere(top)
    order = np.argsort(-smooth[found[:, 0], found[:, 1]])
    return found[order[:most]]


# --- measuring -------------------------------------------------------------------------


@dataclass(frozen=True)
class _Rays:
    """Colours on rays around candidates, from the picture itself."""

    bgr: Image  # (n, rays, radii, 3)
    lab: NDArray[np.uint8]  # the same in L*a*b*
    inside: NDArray[np.bool_]  # (n, rays, radii)
    radius: Array  # (radii,)
    angle: Array  # (rays,)


def _sample_rays(image: Image, camera: Camera, places: Array, disc: Stone, search: Search) -> _Rays:
    radius = np.linspace(0.03, 1.04 if not is_plain(disc) else 1.3, search.radii) * disc.radius
    angle = np.arange(search.rays) * (2 * np.pi / search.rays)
    # Outside the cap the visible surface falls off towards the striking band at half height.
    height = np.interp(
        radius, [1.03 * disc.cap_radius, disc.radius], [disc.cap_height, 0.5 * disc.cap_height]
    )
    around = np.stack([np.cos(angle), np.sin(angle)], -1)[:, None] * radius[None, :, None]
    ice = lifted(camera, places[:, None, None] + around, height)
    pixels = camera.project(ice)
    width, high = camera.size
    inside = (pixels >= 0).all(-1) & (pixels[..., 0] <= width - 1) & (pixels[..., 1] <= high - 1)
    flat = pixels.reshape(-1, search.radii, 2).astype(np.float32)
    rows = 32000  # as many as cv2.remap takes at once
    parts = [
        cv2.remap(image, part[..., 0], part[..., 1], cv2.INTER_LINEAR)
        for part in np.split(flat, range(rows, len(flat), rows))
    ]
    bgr = np.asarray(np.concatenate(parts), np.uint8)
    lab = np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2LAB), np.uint8)
    shape = (*inside.shape, 3)
    return _Rays(
        bgr.reshape(shape),
        lab.reshape(shape),
        np.asarray(inside),
        np.asarray(radius),
        np.asarray(angle),
    )


def _edge(
    fall: Array, seen: NDArray[np.bool_], radius: Array, expected: float, width: float
) -> tuple[Array, Array]:
    """Place of the strongest fall near the expected radius on each ray, and its strength.

    Parameters
    ----------
    fall : ndarray, shape (rays, radii)
        How much the signal falls per step of the radius.
    """
    step = radius[1] - radius[0]
    prior = np.exp(-0.5 * ((radius - expected) / width) ** 2)
    weighted = np.where(seen, np.maximum(fall, 0) * prior, 0)
    best = np.clip(weighted.argmax(1), 2, len(radius) - 3)
    rows = np.arange(len(best))
    near = np.clip(best[:, None] + np.arange(-4, 5), 0, len(radius) - 1)
    strength = np.maximum(fall[rows[:, None], near], 0)
    total = strength.sum(1)
    place = (strength * near).sum(1) / np.maximum(total, 1e-9)
    return radius[0] + step * place, np.where(seen[rows, best], total, 0)


@dataclass(frozen=True)
class _Fit:
    """Concentric circles through edge points: shift of the centre, radii, and how well."""

    shift: Array  # (2,)
    radii: Array  # one per circle
    covariance: Array  # of the shift, (2, 2)
    rms: float
    shares: Array  # one per circle: rays that agree, of those in the picture


def _fit_circles(
    angle: Array,
    edges: Array,
    weights: Array,
    inside: NDArray[np.bool_],
    expected: Array,
    slack: float,
    reach: float,
    noise: float,
) -> _Fit | None:
    """Fit concentric circles to edge points on rays from a centre that is nearly right.

    Linear: edge ≈ R + dx cos φ + dy sin φ, robust by reweighting (Tukey's biweight), with
    the radii held near what is expected.

    Parameters
    ----------
    edges, weights, inside : ndarray, shape (circles, rays)
        Distance of the edge from the centre, 0 or 1 for its use, and whether the ray shows
        that part of the picture.
    expected : ndarray, shape (circles,)
        Radii, m.
    slack, reach : float
        Standard deviation of the radii, and distance from the circle up to which an edge may
        count, as shares of the radius.
    noise : float
        Least standard error of one edge, m.
    """
    circles, rays = edges.shape
    around = np.stack([np.cos(angle), np.sin(angle)], 1)
    design = np.concatenate(
        [np.hstack([around, np.tile(row, (rays, 1))]) for row in np.eye(circles)]
    )
    target = (edges - expected[:, None]).ravel()
    base = weights.ravel().astype(float)
    prior = np.zeros((2 + circles, 2 + circles))
    prior[2:, 2:] = np.diag((noise / (slack * expected)) ** 2)
    prior += 1e-9 * np.eye(2 + circles)
    w, scale = base.copy(), 0.10 * float(expected[-1])
    least = reach * float(expected[-1]) + 2 * noise
    solution = np.zeros(2 + circles)
    residual = target
    for _ in range(6):
        if (w > 0).sum() < 8:
            return None
        solution = np.linalg.solve(
            design.T @ (design * w[:, None]) + prior, design.T @ (w * target)
        )
        residual = target - design @ solution
        spread = 1.4826 * float(np.median(np.abs(residual[w > 0])))
        scale = max(min(scale, 3.5 * spread), least)
        w = base * np.clip(1 - (residual / scale) ** 2, 0, None) ** 2
    fits = w > 0.2 * base
    fits &= base > 0
    if fits.sum() < 8:
        return None
    rms = float(np.sqrt(np.mean(residual[fits] ** 2)))
    normal = design[fits].T @ design[fits] + prior
    covariance = np.linalg.inv(normal)[:2, :2] * max(rms, noise) ** 2
    shares = (fits.reshape(circles, rays) & inside).sum(1) / np.maximum(inside.sum(1), 1)
    return _Fit(solution[:2], expected + solution[2:], covariance, rms, shares)


def _falls(lab: NDArray[np.uint8]) -> Array:
    """Negative derivative of colours along the rays, lightly smoothed, per step of the radius.

    Shape (rays, radii, 3) as given; the derivative of a Gaussian of 1.6 steps.
    """
    x = np.arange(-5, 6, dtype=np.float32)
    gauss = np.exp(-0.5 * (x / 1.6) ** 2)
    slope = gauss * x
    slope /= (slope * x).sum()
    across = np.exp(-0.5 * (np.arange(-2, 3, dtype=np.float32) / 0.6) ** 2)
    return np.asarray(cv2.sepFilter2D(lab, cv2.CV_32F, -slope, across / across.sum()), float)


@dataclass(frozen=True)
class _Measured:
    fit: _Fit
    colour: Array
    visible: float
    evidence: float
    cap_samples: Array
    granite_samples: Array


def _measure_stone(
    rays: _Rays, index: int, appearance: Appearance, disc: Stone, search: Search, noise: float
) -> _Measured | None:
    """Fit the edges of cap and granite; None where there are none."""
    lab, inside, radius = rays.lab[index].astype(float), rays.inside[index], rays.radius
    falls = _falls(rays.lab[index])
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
    capped = _share(signal[:, in_cap] > 0.5, inside[:, in_cap]) > 0.4
    greyed = (
        _share((worth[:, in_ring] < 0.1) & (signal[:, in_ring] < 0.55), inside[:, in_ring]) > 0.4
    )
    cap_edge, cap_strength = _edge(
        falls @ apart, inside, radius, disc.cap_radius, 0.12 * disc.cap_radius
    )
    rim_edge, rim_strength = _edge(
        np.sqrt((falls**2).sum(-1)), inside, radius, disc.radius, 0.05 * disc.radius
    )
    at_cap = inside[:, np.searchsorted(radius, disc.cap_radius)]
    at_rim = inside[:, np.searchsorted(radius, disc.radius)]
    fit = _fit_circles(
        rays.angle,
        np.stack([cap_edge, rim_edge]),
        np.stack(
            [(cap_strength > 0.3) & capped & greyed & at_cap, (rim_strength > 12) & greyed & at_rim]
        ),
        np.stack([at_cap, at_rim]),
        np.array([disc.cap_radius, disc.radius]) * appearance.outline,
        appearance.slack,
        search.edge_reach,
        noise,
    )
    if fit is None:
        return None
    alike = float(np.median(np.abs(ring_pixels[:, 0] - granite[0])))
    visible = float(np.mean(capped & greyed & at_cap))
    evidence = float(fit.shares.sum()) + 0.5 * visible / max(float(at_cap.mean()), 0.3) - alike / 40
    return _Measured(fit, cap, visible, evidence, cap_pixels[::7], ring_pixels[::5])


def _measure_disc(
    rays: _Rays, index: int, disc: Stone, search: Search, noise: float
) -> _Measured | None:
    """Fit the rim of a disc of unknown colours; None where there is no such circle."""
    lab, inside, radius = rays.lab[index], rays.inside[index], rays.radius
    steps = np.sqrt((_falls(lab) ** 2).sum(-1))
    edge, strength = _edge(steps, inside, radius, disc.radius, 0.06 * disc.radius)
    at_rim = inside[:, np.searchsorted(radius, disc.radius)]
    ok = (strength > max(12.0, 0.25 * float(np.median(strength)))) & at_rim
    fit = _fit_circles(
        rays.angle,
        edge[None],
        ok[None],
        at_rim[None],
        np.array([disc.radius]),
        0.03,
        search.edge_reach,
        noise,
    )
    if fit is None:
        return None
    within = radius < 0.8 * disc.radius
    inner = lab[:, within][inside[:, within]]
    seen = float(fit.shares[0] * at_rim.mean())
    none = np.empty((0, 3))
    return _Measured(fit, np.median(inner, axis=0), seen, float(fit.shares[0]), none, none)


def _share(hit: NDArray[np.bool_], inside: NDArray[np.bool_]) -> Array:
    """Share of the samples of each ray that hit, of those inside the picture."""
    return np.asarray((hit & inside).sum(1) / np.maximum(inside.sum(1), 1))


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
    ice = rectify(image, camera, disc, search)
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
    spacing = 1.2 * disc.radius * ice.scale
    peaks = _peaks(response, search.least_score, spacing)
    if not len(peaks):
        return ()
    places = ice.place(peaks[:, 1].astype(float), peaks[:, 0].astype(float))
    scores = response[peaks[:, 0], peaks[:, 1]]
    found: list[Sighting] = []
    for _ in range(2):  # the second time from the centre that the first has found
        rays = _sample_rays(image, camera, places, disc, search)
        found, kept = [], []
        for index, (place, score) in enumerate(zip(places, scores, strict=True)):
            sighting = _measure(rays, index, place, float(score), camera, appearance, disc, search)
            if sighting is not None:
                found.append(sighting)
                kept.append(index)
        if not found:
            return ()
        places, scores = np.array([(item.x, item.y) for item in found]), scores[kept]
    return _apart(found, disc, search)


def _measure(
    rays: _Rays,
    index: int,
    place: Array,
    score: float,
    camera: Camera,
    appearance: Appearance | None,
    disc: Stone,
    search: Search,
) -> Sighting | None:
    pixel = 1 / camera.scale_at(place)
    noise = 0.25 * pixel
    if appearance is None:
        seen = _measure_disc(rays, index, disc, search, noise)
        expected, least = disc.radius, search.least_rim
    else:
        seen = _measure_stone(rays, index, appearance, disc, search, noise)
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
    floor = _floor(camera, place, pixel, disc)
    sd = np.sqrt(np.diag(seen.fit.covariance) + floor**2)
    return Sighting(
        float(x),
        float(y),
        float(sd[0]),
        float(sd[1]),
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


def _floor(camera: Camera, place: Array, pixel: float, disc: Stone) -> float:
    """Least standard error, m: the camera's fit, and what the cap's height leaves open."""
    rms = camera.rms_px if np.isfinite(camera.rms_px) else 0.3
    tilt = 0.0
    if camera.position is not None and np.isfinite(camera.position).all():
        tilt = float(np.hypot(*(place - camera.position[:2]))) / float(camera.position[2])
    return float(np.hypot(0.3 * rms * pixel + 0.05 * pixel, 0.04 * disc.cap_height * tilt))


def _apart(found: Sequence[Sighting], disc: Stone, search: Search) -> tuple[Sighting, ...]:
    """Keep the better of any two that overlap more than two discs can."""
    kept: list[Sighting] = []
    for item in sorted(found, key=lambda s: -s.score):
        if all(np.hypot(item.x - k.x, item.y - k.y) > 1.6 * disc.radius for k in kept):
            kept.append(item)
    return tuple(kept)
