"""Hypotheses of where concentric rings are, from edges alone.

Edges of concentric circles point at one centre: their gradient lines vote for it, under several
foreshortenings of the circles. About a centre, the radii at which edges face it all the way round
must stand as 12 : 8 : 4 ft. Voting for circles along gradients: Kimme, Ballard and Sklansky, 1975,
Communications of the ACM 18, 120.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import HOUSE
from curlshot.vision.optics.rig import OVERHEAD, R4, R8
from curlshot.vision.sheet.tilt import Rounding, Tilt, rounded
from curlshot.vision.video.picture import Image

Array = NDArray[np.float64]

SQUASHES = np.array(
    [(1.0, 0.0), (0.88, 0.0), (0.75, 0.0), (0.62, 0.0), (0.5, 0.0), (0.4, 0.0)]
    + [(squash, turn) for squash in (0.8, 0.6, 0.45) for turn in (-0.35, 0.35)]
    + [(0.65, -0.75), (0.65, 0.75)]
)
"""Height over width of a circle's image, and how far its short axis leans from upright, rad."""

NEARER, LEVEL = ((1.1, 0.0), (1 / 1.1, 0.0), (1.0, -0.15), (1.0, 0.15)), 0.9
"""Factors and turns by which others are tried next to the best of these, if that is below so
much: the more rings are squashed, the fewer lines meet where their shape is not quite right."""

RADII = np.array([HOUSE.twelve_foot, *OVERHEAD.mean[[R8, R4]]])
"""Usual radii of the 12-, 8- and 4-ft edges, m."""

SMALLEST, LARGEST = 0.09, 0.85
"""Radii between which the 12-ft circle is looked for, as fractions of a picture's width, and of its
longer side."""

EDGE_LOW, EDGE_HIGH = 150, 300
"""Hysteresis of the edges, as gradients of the Scharr operator: steps of some 14 and 28 levels."""

CELL = 4.0
"""Side of a cell of the votes, px."""

MARGIN = 0.3
"""How far outside the picture a centre may lie, as a fraction of its width."""

VOTERS = 1500
"""Edge points that vote."""

CENTRES = 3
"""Centres taken from the votes under each foreshortening."""

TRIED = 10
"""Centres about which radii are looked for."""

GUESSES = 6
"""Hypotheses from which on no more are looked for."""

SCALES, APART = 2, 0.3
"""Sizes of rings that are given about one centre, and the least difference of their logarithms: the
4-ft circle and the button in it, whole, may show better than what is in view of the others."""

SAME_PLACE, SAME_SIZE = 0.05, 0.05
"""How far apart hypotheses may be and be one, m, and in the logarithms of size and shape."""

ANGLES = 72
"""Sectors in which a circle's edges are counted."""


@dataclass(frozen=True)
class Guess:
    """Concentric rings.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the picture shows it, px.
    scale : float
        Pixels per metre along the long axis of the circles' images.
    foreshortening : float
        Short over long axis of a circle's image.
    lean : float
        How far the short axis leans from upright, rad, counter-clockwise in the picture.
    score : float
        Falls with the distance from the picture's middle: there is the house that is filmed.
    """

    centre: Array
    scale: float
    foreshortening: float
    lean: float
    score: float


def guesses(image: Image, least: float = 1.0) -> list[Guess]:
    """Look for concentric rings in a small picture, some 320 px wide; the best first.

    Edges count from this share of the usual step on.
    """
    points, gradients = _edges(image, least)
    h, w = image.shape[:2]
    if len(points) < 60:
        return []
    step = max(len(points) // VOTERS, 1)
    some = points[::step], gradients[::step]
    candidates = _candidates(*some, SQUASHES.tolist(), (w, h))
    if candidates and candidates[0][1] < LEVEL:
        _, squash, lean, *_ = candidates[0]
        nearer = [(min(squash * by, 1.0), lean + turn) for by, turn in NEARER]
        candidates += _candidates(*some, nearer, (w, h))
        candidates.sort(key=lambda c: -c[0])
    rings: list[tuple[float, float, Rounding, tuple[Array, Array]]] = []
    for *_, tilt, place in candidates[:TRIED]:
        edges = tilt.level_edges(points, gradients)
        seen = Rounding(tilt, _sharpened(*edges, place))
        aside = abs(float(tilt.pictured(seen.centre)[0]) / w - 0.5)
        rings += [(score - aside, size, seen, edges) for size, score in _radii(*edges, seen)[:1]]
    rings.sort(key=lambda c: -c[0])
    found: list[Guess] = []
    for _, size, seen, edges in rings:
        some = edges[0][::step], edges[1][::step]
        # Rings that are round are told by other sizes than those that are not yet.
        rounder = rounded(*some, seen, size * RADII)
        sizes = _radii(*edges, rounder)
        if size * RADII[0] ** 2 / RADII[2] < LARGEST * max(w, h):
            sizes.append((size * RADII[0] / RADII[2], 0.0))  # The rings may be those within 4 ft.
        for other, score in sizes:
            new = abs(np.log(other / size)) > SAME_SIZE
            own = rounded(*some, rounder, other * RADII) if new else rounder
            guess = _guess(own, other, score)
            if not any(_alike(guess, old) for old in found):
                found.append(guess)
        if len(found) >= GUESSES:
            break
    found.sort(key=lambda c: -c.score)
    return found


def _candidates(
    points: Array, gradients: Array, ways: Sequence[tuple[float, float]], size: tuple[int, int]
) -> list[tuple[float, float, float, Tilt, Array]]:
    """Centres of rings so squashed and leaning: votes, both of these, the tilt, and the place."""
    found = []
    for squash, lean in ways:
        tilt = Tilt.of(squash, lean, size)
        votes = _votes(*tilt.level_edges(points, gradients), tilt)
        found += [(height, squash, lean, tilt, place) for height, place in votes]
    return sorted(found, key=lambda c: -c[0])


def _guess(seen: Rounding, scale: float, score: float) -> Guess:
    """Say how the picture has rings that are round, of so many px per metre, about their tee."""
    tee, *ends = seen.pictured(np.array([[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]]))
    way, (long, short), _ = np.linalg.svd(np.stack([end - tee for end in ends], -1) / 0.01)
    lean = float(np.arctan(way[0, 1] / way[1, 1])) if way[1, 1] else np.pi / 2
    aside = abs(float(tee[0]) / seen.tilt.size[0] - 0.5)
    return Guess(tee, float(scale * long), float(short / long), lean, score - aside)


def _alike(one: Guess, other: Guess) -> bool:
    """Whether a fit would make the same of both."""
    apart = float(np.hypot(*(one.centre - other.centre))) / other.scale
    ratios = np.log([one.scale / other.scale, one.foreshortening / other.foreshortening])
    return apart < SAME_PLACE and bool(np.abs(ratios).max() < SAME_SIZE)


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.hypot(vectors[:, 0], vectors[:, 1])[:, None])


def _edges(image: Image, least: float) -> tuple[Array, Array]:
    """Thinned edge points, shape (n, 2), and the unit gradients there."""
    soft = cv2.GaussianBlur(image, (0, 0), 1.0)
    gx = cv2.Scharr(soft, cv2.CV_16S, 1, 0)
    gy = cv2.Scharr(soft, cv2.CV_16S, 0, 1)
    size = np.abs(gx) + np.abs(gy)
    dx, dy, most = gx[..., 0].copy(), gy[..., 0].copy(), size[..., 0].copy()
    for channel in (1, 2):
        more = size[..., channel] > most
        dx[more], dy[more] = gx[more, channel], gy[more, channel]
        most = np.maximum(most, size[..., channel])
    edges = cv2.Canny(dx, dy, least * EDGE_LOW, least * EDGE_HIGH, L2gradient=True)
    y, x = np.nonzero(edges)
    gradient = np.stack([dx[y, x], dy[y, x]], axis=-1).astype(float)
    return np.stack([x, y], axis=-1).astype(float), _unit(gradient)


def _votes(points: Array, gradients: Array, tilt: Tilt) -> list[tuple[float, Array]]:
    """Places, also outside the picture, where most gradient lines meet: votes and place."""
    w, h = tilt.size
    corners = tilt.level(np.array([[0.0, 0.0], [w, 0.0], [0.0, h], [w, h]]))
    low = corners.min(0) - MARGIN * w
    across, down = ((np.ptp(corners, axis=0) + 2 * MARGIN * w) / CELL).astype(int) + 1
    reach = np.arange(2, 0.62 * max(w, h) / CELL, dtype=np.float32)
    rim = len(reach) + 2  # so wide that no line leaves the cells: that need not be looked after
    reach = np.concatenate([-reach, reach])[:, None]
    x, y = ((points - low) / CELL + rim).astype(np.float32).T.copy()
    right, up = gradients.astype(np.float32).T.copy()
    cell = (y + up * reach).astype(np.int32)
    cell *= across + 2 * rim
    cell += (x + right * reach).astype(np.int32)
    votes = np.bincount(cell.ravel(), minlength=(across + 2 * rim) * (down + 2 * rim))
    votes = votes.reshape(down + 2 * rim, -1)[rim:-rim, rim:-rim]
    heat = cv2.GaussianBlur(votes.astype(np.float32), (0, 0), 1.0)
    # Straight edges lay broad ridges: a centre stands out from its surroundings.
    heat = np.asarray(heat - cv2.blur(heat, (15, 15)))
    found = []
    for _ in range(CENTRES):
        _, height, _, (cx, cy) = cv2.minMaxLoc(heat)
        if height <= 0:
            break
        found.append((float(height), low + (np.array([cx, cy]) + 0.5) * CELL))
        cv2.circle(heat, (cx, cy), 5, 0.0, -1)
    return found


def _sharpened(points: Array, gradients: Array, centre: Array) -> Array:
    """Where the gradient lines that pass close to a centre meet, by least squares."""
    for near in (2.0 * CELL, 1.2 * CELL):
        d = points - centre
        aside = d[:, 0] * gradients[:, 1] - d[:, 1] * gradients[:, 0]
        use = (np.abs(aside) < near) & ((d**2).sum(1) > (3 * CELL) ** 2)
        if use.sum() < 20:
            break
        normal = np.stack([gradients[use, 1], -gradients[use, 0]], axis=-1)
        matrix = normal.T @ normal + np.eye(2)
        centre = centre + np.linalg.solve(matrix, normal.T @ aside[use])
    return centre


def _radii(points: Array, gradients: Array, seen: Rounding) -> list[tuple[float, float]]:
    """Pixels per metre that put edges facing the centre at 12 : 8 : 4 ft, and their scores."""
    w, side = seen.tilt.size[0], max(seen.tilt.size)
    d, gradients = seen.of_edges(points, gradients)
    r = np.hypot(d[:, 0], d[:, 1])
    facing = (d * gradients).sum(1) / np.maximum(r, 1e-9)
    tolerance = np.maximum(0.97 - 2.0 / np.maximum(r, 4.0), 0.8)
    largest = max(int((LARGEST + 0.02) * side), int(LARGEST * side) + 2)
    near = (np.abs(facing) > tolerance) & (r < largest - 1)
    sector = (np.arctan2(d[near, 1], d[near, 0]) * (ANGLES / (2 * np.pi))).astype(int) % ANGLES
    # Which sectors hold an edge, per polarity and radius: many edges in one count once.
    held = np.zeros((2, largest, ANGLES), np.uint8)
    held[(facing[near] > 0).astype(int), r[near].astype(int), sector] = 1
    kernel = np.ones((3, 1), np.uint8)
    arc = np.maximum(*(np.asarray(cv2.dilate(side, kernel)).mean(1) for side in held))
    clutter = cv2.blur(arc.reshape(-1, 1), (1, 21)).ravel()
    visible = _visible(seen, largest)
    radius = np.arange(SMALLEST * w, LARGEST * side, 0.5)
    at = np.round(radius[:, None] * RADII / RADII[0]).astype(int)
    got = np.clip(arc[at] - 0.7 * clutter[at], 0, None)
    share = np.where(visible[at] > 0.05, got / np.maximum(visible[at], 0.05), 0)
    # Full circles beat pieces of one; what should be seen and is not counts against.
    score = (got + 0.35 * share).sum(1)
    score[(share[:, 0] < 0.2) | ((share > 0.2).sum(1) < 2)] = 0
    found = []
    for _ in range(SCALES):
        best = int(score.argmax())
        if score[best] > 0:
            found.append((float(radius[best] / HOUSE.twelve_foot), float(score[best])))
        score[np.abs(np.log(radius / radius[best])) < APART] = 0
    return found


def _visible(seen: Rounding, largest: int) -> Array:
    """Fraction of the circle of each radius that lies in the picture."""
    angle = np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    some = np.arange(0, largest + 2, 3)
    place = seen.pictured(some[:, None, None] * way)
    share = ((place > 1) & (place < np.array(seen.tilt.size) - 2)).all(-1).mean(1)
    return np.asarray(np.interp(np.arange(largest), some, share))
