"""Find the house in one picture, whatever its colours.

Edges of concentric circles point at one centre: their gradients vote for it, under several
foreshortenings; the radii at which edges face that centre must stand as 12 : 8 : 4 ft. Each
hypothesis is then fitted with a camera and judged by how much of the circles it explains.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from data.sheet import HOUSE
from vision.adjust import Solution, solve
from vision.camera import Camera
from vision.lines import sides, upright
from vision.marks import Evidence, Image, measure
from vision.pose import (
    ANYWHERE,
    OVERHEAD,
    View,
    aim,
    camera,
    rescaled,
    start_rig,
)

Array = NDArray[np.float64]

WORK_WIDTH = 640
SHARING = 20.0
"""Edge points of one frame that share an error of the paint, about 30° of a circle."""

FORESHORTENINGS = (1.0, 0.9, 0.78, 0.64, 0.5)
RATIOS = np.array([1.0, 1.2135 / HOUSE.twelve_foot, 0.619 / HOUSE.twelve_foot])


@dataclass(frozen=True)
class HouseFit:
    """The house in one picture.

    Attributes
    ----------
    camera : Camera
    view, rig : View, ndarray
        The camera's parts (see `vision.pose`).
    evidence : Evidence
        The marks it rests on.
    rms_px : float
    overhead : bool
        Whether it looks like a camera that hangs over the tee.
    """

    camera: Camera
    view: View
    rig: Array
    evidence: Evidence
    rms_px: float
    overhead: bool


@dataclass(frozen=True)
class _Guess:
    centre: Array
    scale: float
    foreshortening: float
    score: float


def find_house(image: Image, *, frame: int = 0, t: float = 0.0) -> HouseFit | None:
    """Find the house in a picture.

    Parameters
    ----------
    image : ndarray of uint8, shape (h, w, 3)

    Returns
    -------
    HouseFit or None
        The most complete house; None where no house can be made out.
    """
    factor = WORK_WIDTH / image.shape[1]
    small = cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    best: tuple[float, Solution] | None = None
    for guess in _guesses(np.asarray(small, np.uint8)):
        solution, evidence = _fit(np.asarray(small, np.uint8), guess)
        score = judge(evidence)
        if score > 0 and (best is None or score > best[0]):
            best = (score, solution)
    if best is None:
        return None
    return _refine(image, best[1], factor, frame, t)


def _gradients(image: Image) -> tuple[Array, Array]:
    """Thinned edge points, shape (n, 2), and the unit gradients there."""
    soft = cv2.GaussianBlur(image, (0, 0), 1.2)
    gx = cv2.Scharr(soft, cv2.CV_16S, 1, 0)
    gy = cv2.Scharr(soft, cv2.CV_16S, 0, 1)
    size = np.abs(gx.astype(np.int32)) + np.abs(gy.astype(np.int32))
    channel = size.argmax(-1)[..., None]
    dx = np.take_along_axis(gx, channel, -1)[..., 0]
    dy = np.take_along_axis(gy, channel, -1)[..., 0]
    edges = cv2.Canny(dx, dy, 150, 400, L2gradient=True)
    y, x = np.nonzero(edges)
    gradient = np.stack([dx[y, x], dy[y, x]], axis=-1).astype(float)
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    return np.stack([x, y], axis=-1).astype(float), gradient


def _guesses(image: Image) -> Iterator[_Guess]:
    """Hypotheses of centre, scale and foreshortening, the best first."""
    points, gradients = _gradients(image)
    h, w = image.shape[:2]
    found: list[_Guess] = []
    if len(points) < 60:
        return
    for squash in FORESHORTENINGS:
        p = points / [1.0, squash]
        g = gradients * [1.0, squash]
        g /= np.linalg.norm(g, axis=1, keepdims=True)
        tall = h / squash
        for centre in _centres(p, g, w, tall):
            scale, score = _radii(p, g, centre, w, tall)
            if score > 0:
                found.append(_Guess(centre * [1.0, squash], scale, squash, score))
    found.sort(key=lambda c: -c.score)
    yield from found[:5]


def _centres(points: Array, gradients: Array, w: float, h: float, count: int = 3) -> list[Array]:
    """Places, also outside the picture, where most gradient lines meet."""
    cell, margin = 4.0, 0.35
    left, top = -margin * w, -margin * h
    across, down = int((1 + 2 * margin) * w / cell) + 1, int((1 + 2 * margin) * h / cell) + 1
    reach = np.arange(16.0, 0.62 * w, cell)
    reach = np.concatenate([-reach, reach])
    step = max(len(points) // 5000, 1)
    p, g = points[::step], gradients[::step]
    x = ((p[:, :1] + g[:, :1] * reach - left) / cell).astype(np.int64)
    y = ((p[:, 1:] + g[:, 1:] * reach - top) / cell).astype(np.int64)
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
    near = np.abs(facing) > tolerance
    largest = int(0.95 * w)
    bins = np.arange(largest + 1) - 0.5
    angle = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    ring = np.arange(largest)[:, None]
    x, y = centre[0] + ring * np.cos(angle), centre[1] + ring * np.sin(angle)
    visible = ((x > 1) & (x < w - 2) & (y > 1) & (y < h - 2)).mean(1)
    either = np.maximum(
        np.histogram(r[near & (facing > 0)], bins)[0],
        np.histogram(r[near & (facing < 0)], bins)[0],
    ).astype(float)
    wide = np.convolve(either, np.ones(5), "same")
    length = 2 * np.pi * np.maximum(np.arange(largest), 4)
    arc = np.minimum(wide / length, visible)
    best_scale, best_score = 0.0, 0.0
    for twelve in np.arange(50.0, 0.85 * w, 1.0):
        if twelve >= largest - 4:
            break
        at = np.round(twelve * RATIOS).astype(int)
        got = np.array([arc[max(i - 2, 0) : i + 3].max() for i in at])
        share = np.where(visible[at] > 0.05, got / np.maximum(visible[at], 0.05), 0)
        # Full circles beat pieces of one; what should be seen and is not counts against.
        score = float((got + 0.35 * share).sum())
        if share[0] > 0.2 and (share > 0.2).sum() >= 2 and score > best_score:
            best_scale, best_score = twelve / HOUSE.twelve_foot, score
    return best_scale, best_score


def _fit(image: Image, guess: _Guess) -> tuple[Solution, Evidence]:
    size = (image.shape[1], image.shape[0])
    steep = guess.foreshortening > 0.85
    prior = OVERHEAD if steep else ANYWHERE
    s = guess.foreshortening
    distance = 8.5 if steep else 10.0
    tilt = 0.0 if steep else float(np.sqrt(1 - s**2))
    position = (0.0, -distance * tilt, distance * (1.0 if steep else s))
    rig = start_rig(prior, position)
    view = aim(guess.centre, guess.scale, position, size)
    thickness = guess.scale * (HOUSE.twelve_foot - HOUSE.eight_foot)
    solution = None
    for reach in (0.3 * thickness, 0.2 * thickness, 0.15 * thickness):
        evidence = measure(image, view.vector, rig, reach=max(reach, 3.0), spacing=4, lines=False)
        if len(evidence.marks) < 30:
            break
        solution = solve([evidence.marks], [view], rig, size, prior=prior, sharing=SHARING)
        view, rig = solution.views[0], solution.rig
    evidence = measure(image, view.vector, rig, reach=5.0, spacing=4, lines=False)
    if solution is None or len(evidence.marks) < 30:
        return Solution(rig, (view,), np.zeros((1, 1)), np.zeros(1), (), 0), evidence
    return solution, evidence


def judge(evidence: Evidence) -> float:
    """How much of a house this is; 0 where it is none."""
    support, covered = evidence.support, evidence.covered
    if covered[0] < 0.12 or support[0] < 0.35:
        return 0.0
    seen = evidence.visible > 0.05
    if (support[seen] > 0.3).sum() < 2:
        return 0.0
    return float(covered.sum() + 0.5 * support[seen].mean())


def _refine(
    image: Image, solution: Solution, factor: float, frame: int, t: float
) -> HouseFit | None:
    """Fit at full resolution, with the lines."""
    size = (image.shape[1], image.shape[0])
    view, rig = rescaled(solution.views[0], 1 / factor), solution.rig
    evidence, fit = None, None
    for lines, reach in ((False, 4 / factor), (True, 8.0), (True, 6.0)):
        if lines and fit is not None and evidence is not None and reach == 8.0:
            view, rig = upright(image, view, rig)
            rig = sides(image, view, rig)
        evidence = measure(image, view.vector, rig, reach=max(reach, 6.0), lines=lines)
        if len(evidence.marks) < 30:
            return None
        fit = solve([evidence.marks], [view], rig, size, prior=OVERHEAD, sharing=SHARING)
        view, rig = fit.views[0], fit.rig
    assert evidence is not None and fit is not None
    if judge(evidence) == 0:
        return None
    rms = float(fit.rms[0])
    return HouseFit(
        camera(view, rig, size, frame=frame, t=t, rms_px=rms), view, rig, evidence, rms, True
    )
