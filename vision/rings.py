"""Hypotheses of where concentric rings are, from edges alone.

Edges of concentric circles point at one centre: their gradient lines vote for it, under several
foreshortenings along the picture's height. About a centre, the radii at which edges face it all
the way round must stand as 12 : 8 : 4 ft. Voting for circles along gradients: Kimme, Ballard and
Sklansky, 1975, Communications of the ACM 18, 120.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.pose import OVERHEAD, R4, R8

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

FORESHORTENINGS = (1.0, 0.9, 0.78, 0.64, 0.5)

RATIOS = np.array([1.0, *(OVERHEAD.mean[[R8, R4]] / HOUSE.twelve_foot)])

SMALLEST = 0.09
"""Least radius of the 12-ft circle that is looked for, as a fraction of the picture's width."""

LARGEST = 0.85

EDGE_LOW, EDGE_HIGH = 150, 300
"""Hysteresis of the edges, as gradients of the Scharr operator: steps of some 14 and 28 levels."""

ANGLES = 72
"""Sectors in which a circle's edges are counted."""


@dataclass(frozen=True)
class Guess:
    """Concentric rings.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Px.
    scale : float
        Pixels per metre along the picture's width.
    foreshortening : float
        Height over width of a circle.
    score : float
        Falls with the distance from the picture's middle: there is the house that is filmed.
    """

    centre: Array
    scale: float
    foreshortening: float
    score: float


def guesses(image: Image, count: int = 5) -> list[Guess]:
    """Look for concentric rings in a small picture; the best first."""
    points, gradients = _edges(image)
    h, w = image.shape[:2]
    found: list[Guess] = []
    if len(points) < 60:
        return found
    for squash in FORESHORTENINGS:
        p = points / [1.0, squash]
        g = gradients * [1.0, squash]
        g /= np.linalg.norm(g, axis=1, keepdims=True)
        tall = h / squash
        for centre in _centres(p, g, w, tall):
            scale, score = _radii(p, g, centre, w, tall)
            if score > 0:
                score -= abs(centre[0] / w - 0.5)
                found.append(Guess(centre * [1.0, squash], scale, squash, score))
    found.sort(key=lambda c: -c.score)
    return found[:count]


def _edges(image: Image) -> tuple[Array, Array]:
    """Thinned edge points, shape (n, 2), and the unit gradients there."""
    soft = cv2.GaussianBlur(image, (0, 0), 1.2)
    gx = cv2.Scharr(soft, cv2.CV_16S, 1, 0)
    gy = cv2.Scharr(soft, cv2.CV_16S, 0, 1)
    size = np.abs(gx) + np.abs(gy)
    dx, dy, most = gx[..., 0].copy(), gy[..., 0].copy(), size[..., 0].copy()
    for channel in (1, 2):
        more = size[..., channel] > most
        dx[more], dy[more] = gx[more, channel], gy[more, channel]
        most = np.maximum(most, size[..., channel])
    edges = cv2.Canny(dx, dy, EDGE_LOW, EDGE_HIGH, L2gradient=True)
    y, x = np.nonzero(edges)
    gradient = np.stack([dx[y, x], dy[y, x]], axis=-1).astype(float)
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    return np.stack([x, y], axis=-1).astype(float), gradient


def _centres(points: Array, gradients: Array, w: float, h: float, count: int = 3) -> list[Array]:
    """Places, also outside the picture, where most gradient lines meet."""
    cell, margin = 4.0, 0.35
    left, top = -margin * w, -margin * h
    across, down = int((1 + 2 * margin) * w / cell) + 1, int((1 + 2 * margin) * h / cell) + 1
    reach = np.arange(16.0, 0.62 * w, cell)
    reach = np.concatenate([-reach, reach]).astype(np.float32)
    step = max(len(points) // 4000, 1)
    p, g = points[::step].astype(np.float32), gradients[::step].astype(np.float32)
    x = ((p[:, :1] + g[:, :1] * reach - left) * (1 / cell)).astype(np.int32)
    y = ((p[:, 1:] + g[:, 1:] * reach - top) * (1 / cell)).astype(np.int32)
    inside = (x >= 0) & (x < across) & (y >= 0) & (y < down)
    votes = np.bincount((y * across + x)[inside], minlength=across * down)
    heat = cv2.GaussianBlur(votes.reshape(down, across).astype(np.float32), (0, 0), 1.0)
    # Straight edges lay broad ridges: a centre stands out from its surroundings.
    heat = np.asarray(heat - cv2.blur(heat, (15, 15)))
    centres = []
    for _ in range(count):
        _, top_value, _, (cx, cy) = cv2.minMaxLoc(heat)
        if top_value <= 0:
            break
        centres.append(np.array([left + (cx + 0.5) * cell, top + (cy + 0.5) * cell]))
        cv2.circle(heat, (cx, cy), 6, 0.0, -1)
    return centres


def _radii(
    points: Array, gradients: Array, centre: Array, w: float, h: float
) -> tuple[float, float]:
    """Pixels per metre that puts edges facing the centre at 12 : 8 : 4 ft, and its score."""
    d = points - centre
    r = np.hypot(d[:, 0], d[:, 1])
    facing = (d * gradients).sum(1) / np.maximum(r, 1e-9)
    tolerance = np.maximum(0.97 - 4.0 / np.maximum(r, 8.0), 0.8)
    largest = int((LARGEST + 0.02) * w)
    near = (np.abs(facing) > tolerance) & (r < largest - 1)
    sector = (np.arctan2(d[near, 1], d[near, 0]) * (ANGLES / (2 * np.pi))).astype(int) % ANGLES
    # Which sectors hold an edge, per polarity and radius: many edges in one count once.
    held = np.zeros((2, largest, ANGLES), np.uint8)
    held[(facing[near] > 0).astype(int), r[near].astype(int), sector] = 1
    kernel = np.ones((5, 1), np.uint8)
    arc = np.maximum(*(np.asarray(cv2.dilate(side, kernel)).mean(1) for side in held))
    clutter = cv2.blur(arc.reshape(-1, 1), (1, 41)).ravel()
    visible = _visible(centre, largest, w, h)
    radius = np.arange(SMALLEST * w, LARGEST * w)
    at = np.round(radius[:, None] * RATIOS).astype(int)
    peak = cv2.dilate(arc.reshape(-1, 1), np.ones((3, 1), np.uint8)).ravel()
    got = np.clip(peak[at] - 0.7 * clutter[at], 0, None)
    share = np.where(visible[at] > 0.05, got / np.maximum(visible[at], 0.05), 0)
    # Full circles beat pieces of one; what should be seen and is not counts against.
    score = (got + 0.35 * share).sum(1)
    score[(share[:, 0] < 0.2) | ((share > 0.2).sum(1) < 2)] = 0
    best = int(score.argmax())
    return float(radius[best] / HOUSE.twelve_foot), float(score[best])


def _visible(centre: Array, largest: int, w: float, h: float) -> Array:
    """Fraction of the circle of each radius that lies in the picture."""
    angle = np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    ring = np.arange(largest)[:, None]
    x, y = centre[0] + ring * np.cos(angle), centre[1] + ring * np.sin(angle)
    return np.asarray(((x > 1) & (x < w - 2) & (y > 1) & (y < h - 2)).mean(1))
