"""Where discs may lie: places on the rectified ice that answer to a template.

A colour is worth +1 where it may be a cap, −1 where it may be granite and 0 elsewhere; the
mean over the cap less the mean over the ring of granite around it is then 2 on a stone and 0
on anything of one colour, be it of the colour of a cap.

Discs of which only the radii of their circles are known are found by the share of the gradient
that points along the radius (a structure tensor summed over the circles), of either sign.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import Stone
from curlshot.vision.detection.appearance import Appearance, any_stone, membership
from curlshot.vision.detection.ice_map import IceMap, rectify
from curlshot.vision.detection.patch import CAP_END, RING_BEGIN, RING_END, in_granite, is_plain
from curlshot.vision.detection.shape import NO_BALLOT, ballot
from curlshot.vision.optics.camera import Camera
from curlshot.vision.video.colour import lab_of
from curlshot.vision.video.picture import Picture, colours_at

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bounds = tuple[float, float, float, float]

MOST_PLACES = 60
"""Places that are given of one picture, the strongest."""

BY_FOURIER = 121
"""Weights from which on OpenCV correlates by Fourier transforms, whatever they are."""

LEAST_IN_VIEW = 0.4
"""Share of cap or ring of which at least the mean is taken: less in view counts less."""


@dataclass(frozen=True)
class Candidates:
    """Where discs may be.

    Attributes
    ----------
    places : ndarray, shape (n, 2)
        m, strongest first.
    appearance : Appearance or None
        By what they were sought; None for plain discs.
    say : ndarray, shape (sizes,)
        What they say of how large caps are (`curlshot.vision.detection.shape`), where no colour is
        known.
    """

    places: Array
    appearance: Appearance | None
    say: Array = field(default_factory=lambda: NO_BALLOT)


def seek(
    image: Picture,
    camera: Camera,
    appearance: Appearance | None,
    disc: Stone,
    bounds: Bounds,
    *,
    radius_px: float,
    least: float,
) -> Candidates:
    """Look for discs on a part of the ice.

    Parameters
    ----------
    image, camera : Picture, Camera
        The picture, and its camera.
    appearance : Appearance, optional
        What stones look like, or `BY_SHAPE`; without it, what any stone with a coloured cap looks
        like.
    disc : Stone
        Sizes; a disc without a cap is sought by its rim.
    bounds : (x0, x1, y0, y1)
        The part of the ice, m.
    radius_px : float
        Radius of a disc on the rectified map, px: the finer, the dearer.
    least : float
        Response, 0 to 2, from which a place is given.
    """
    scale = radius_px / disc.radius
    ice = rectify(image, camera, bounds, scale=scale, height=disc.cap_height)
    if ice is None or not ice.valid.any():
        return Candidates(np.empty((0, 2)), appearance)
    known = appearance
    if known is None and not is_plain(disc):
        white = np.percentile(lab_of(ice.image)[ice.valid][:, 0], 75)
        known = any_stone(max(round(float(white)), 60))
    responses = _responses(ice, known, disc)
    # Nearer than stones can be: paint of the cap's colour beside a stone may answer more strongly.
    peaks = np.concatenate([_peaks(one, least, 1.1 * radius_px) for one in responses])
    places = ice.place(peaks[:, 1], peaks[:, 0])
    if known is None or known.caps:
        return Candidates(places, known)
    return Candidates(places, known, ballot(ice, known, peaks[:, ::-1], disc))


def seek_about(
    image: Picture,
    camera: Camera,
    places: Array,
    appearance: Appearance | None,
    disc: Stone,
    *,
    radius_px: float,
    reach: float,
) -> Array:
    """Look for one disc about each of a few places, all at once.

    Parameters
    ----------
    image, camera : Picture, Camera
        The picture, and its camera.
    places : ndarray, shape (n, 2)
        Where discs are expected, m.
    appearance, disc, radius_px : Appearance, Stone, float
        As for `seek`.
    reach : float
        How far from there they may be along x and along y, in radii.

    Returns
    -------
    ndarray, shape (n, 2)
        Where the response is strongest, m.
    """
    scale, span = radius_px / disc.radius, int(np.ceil(reach * radius_px))
    half = span + int(np.ceil(radius_px)) + 3
    size = 2 * half + 1
    offset = np.arange(-half, half + 1) / scale
    grid = np.stack(np.meshgrid(offset, -offset), -1)
    seen = camera.project(places[:, None, None] + grid, disc.cap_height)
    pixels: Floats = seen.reshape(-1, size, 2).astype(np.float32)
    limit = np.array([image.shape[1], image.shape[0]]) - 1
    valid = np.all((pixels >= 0) & (pixels <= limit), axis=-1)
    patches = colours_at(image, pixels[..., 0], pixels[..., 1])
    ice = IceMap(patches, valid, 0.0, 0.0, scale)
    # One above the other: at the places that may be chosen a patch's response is its own.
    sharp = np.array(_responses(ice, appearance, disc)).sum(0)
    response = cv2.GaussianBlur(sharp, (0, 0), 0.7)
    response = np.asarray(response, np.float32).reshape(-1, size, size)
    inner = response[:, half - span : half + span + 1, half - span : half + span + 1]
    best = inner.reshape(len(places), -1).argmax(1)
    row, column = (index + half - span for index in np.unravel_index(best, inner.shape[1:]))
    shift = _summit(response, np.arange(len(places)), row, column)
    return places + (np.stack([column, -row], 1) + shift * [1, -1] + [-half, half]) / scale


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


def _responses(ice: IceMap, appearance: Appearance | None, disc: Stone) -> list[Floats]:
    """How much each place looks like a disc, 0 to 2, in one way or two."""
    if is_plain(disc):
        return [_round_response(ice, [disc.radius])]
    assert appearance is not None
    out = []
    if appearance.membership is not None:
        out.append(_stone_response(ice, appearance.membership, disc))
    if appearance.own:
        radii = np.array([disc.cap_radius, disc.radius]) * appearance.outline
        out.append(_round_response(ice, radii.tolist()))
    return out


def _stone_response(ice: IceMap, table: Floats, disc: Stone) -> Floats:
    worth = membership(ice.image, table) * ice.valid
    unit = ice.scale
    size = int(np.ceil(disc.radius * unit))
    cap = _annulus(0.0, CAP_END * disc.cap_radius * unit, size)
    begin, end = (in_granite(disc, share) * unit for share in (RING_BEGIN, RING_END))
    ring = _annulus(begin, max(end, begin + 0.5), size)
    if ice.valid.all():
        return _filtered(worth, cap - ring)
    valid = ice.valid.astype(np.float32)
    parts = [
        _filtered(worth, kernel) / np.maximum(_filtered(valid, kernel), LEAST_IN_VIEW)
        for kernel in (cap, ring)
    ]
    return np.asarray(parts[0] - parts[1], np.float32)


def _filtered(values: Floats, kernel: Floats) -> Floats:
    """Correlate a map with a kernel of as many rows as columns, an odd number."""
    half = len(kernel) // 2
    upper, lower = kernel[: half + 1], kernel[half:].copy()
    if lower.size >= BY_FOURIER:
        return _correlated(values, kernel, half)
    # Directly, half by half: of a ring most weights are 0.
    lower[0] = 0
    return _correlated(values, upper, half) + _correlated(values, lower, 0)


def _correlated(values: Floats, kernel: Floats, row: int) -> Floats:
    """Correlate a map with a kernel about the middle of one of its rows; beyond the map is 0."""
    anchor = kernel.shape[1] // 2, row
    return np.asarray(
        cv2.filter2D(values, cv2.CV_32F, kernel, anchor=anchor, borderType=cv2.BORDER_CONSTANT),
        np.float32,
    )


def _round_response(ice: IceMap, radii: Sequence[float]) -> Floats:
    """Share of the gradient near concentric circles that points along their radii, 0 to 2."""
    grey = cv2.GaussianBlur(ice.image, (0, 0), 0.8).astype(np.float32)
    gx = cv2.Sobel(grey, cv2.CV_32F, 1, 0, scale=1 / 8)
    gy = cv2.Sobel(grey, cv2.CV_32F, 0, 1, scale=1 / 8)
    inner = cv2.erode(ice.valid.astype(np.uint8), np.ones((5, 5), np.uint8))
    # Strong edges shall not outvote long ones: each pixel counts at most as much as a clear edge.
    energy = (gx**2 + gy**2).sum(2)
    weight = inner / (energy + 6.0**2)
    xx, xy, yy = ((u * v).sum(2) * weight for u, v in ((gx, gx), (gx, gy), (gy, gy)))
    outer = [radius * ice.scale for radius in radii]
    size = int(np.ceil(outer[-1] + 2))
    annuli = [_annulus(radius - 1.3, radius + 1.3, size) for radius in outer]
    ring = np.asarray(sum(annuli) / len(outer), np.float32)
    offset = np.arange(-size, size + 1, dtype=np.float32)
    twice = 2 * np.arctan2(offset[:, None], offset[None, :])
    # Radial energy counts for a circle, energy along the circle against it.
    total = _filtered(xx - yy, ring * np.cos(twice)) + _filtered(2 * xy, ring * np.sin(twice))
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


def _peaks(response: Floats, least: float, spacing_px: float) -> Array:
    """Local maxima, strongest first: row and column to a fraction, shape (n, 2)."""
    reach = 2 * int(0.5 * spacing_px) + 1
    shape = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (reach, reach))
    smooth = cv2.GaussianBlur(response, (0, 0), 0.7)
    top = (smooth >= cv2.dilate(smooth, shape)) & (smooth > least)
    top[[0, -1]] = top[:, [0, -1]] = False
    row, column = np.nonzero(top)
    height = smooth[row, column].astype(float)
    order = _far_apart(np.stack([row, column], 1), np.argsort(-height), spacing_px)[:MOST_PLACES]
    row, column = row[order], column[order]
    one = np.zeros(len(row), np.intp)
    shift = _summit(np.asarray(smooth[None], np.float32), one, row, column)
    return np.stack([row, column], 1) + shift[:, ::-1]


def _summit(
    maps: Floats, index: NDArray[np.intp], row: NDArray[np.intp], column: NDArray[np.intp]
) -> Array:
    """Shift (n, 2), columns and rows, from pixels of maps to the summits there."""
    height = maps[index, row, column].astype(float)
    shifts = []
    for before, after in (
        (maps[index, row, column - 1], maps[index, row, column + 1]),
        (maps[index, row - 1, column], maps[index, row + 1, column]),
    ):
        bend = 2 * height - before - after
        shift = np.where(bend > 1e-6, 0.5 * (after - before) / np.maximum(bend, 1e-6), 0.0)
        shifts.append(np.clip(shift, -0.5, 0.5))
    return np.stack(shifts, 1)
