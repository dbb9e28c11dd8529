"""Concentric circles about places on the ice: edges on rays, and their fit.

All places of a picture are treated at once: every array begins with the axis of the places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.rays import Rays, directions

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Bools = NDArray[np.bool_]

_EDGE_WIDTH = 0.010
"""Half the width of what is taken for one edge, m; at least two samples, at most four."""

_SMOOTH = 1.6
"""Standard deviation of the Gaussian whose derivative tells how much falls, steps."""


@dataclass(frozen=True)
class Rim:
    """One of the concentric circles that are sought about each of n places.

    Attributes
    ----------
    fall : ndarray, shape (n, rays, radii)
        How much what ends at the circle falls per step of the radius.
    use, inside : ndarray of bool, shape (n, rays)
        Rays that may show it; rays on which the picture shows that place.
    radius, width : float
        Where the edge is expected, and the standard deviation of that, m.
    strength : float
        Least that an edge falls by.
    weight : ndarray, shape (n,)
        What an edge counts.
    """

    fall: Floats
    use: Bools
    inside: Bools
    radius: float
    width: float
    strength: float
    weight: Array


@dataclass(frozen=True)
class Fits:
    """Concentric circles through edge points about n places.

    Attributes
    ----------
    ok : ndarray of bool, shape (n,)
        Where there are edges enough; what is said of the others means nothing.
    shift : ndarray, shape (n, 2)
        From the place to the centre, m.
    radii : ndarray, shape (n, circles)
    covariance : ndarray, shape (n, 2, 2)
        Of the shift, m².
    rms : ndarray, shape (n,)
        Root of the mean square distance of the edges from the circles, m.
    shares : ndarray, shape (n, circles)
        Rays that agree, of those in the picture.
    """

    ok: Bools
    shift: Array
    radii: Array
    covariance: Array
    rms: Array
    shares: Array


@dataclass(frozen=True)
class _Bands:
    """Where the edges of the rims may lie, all rims side by side.

    Attributes
    ----------
    fall : ndarray, shape (n, circles, rays, steps + 2 half)
        Of the rims; 0 beyond the reach of each.
    radius : ndarray, shape (circles, steps)
        m, without the margins.
    width : ndarray, shape (circles,)
        Standard deviation of where an edge is expected, m.
    half : int
        Steps on either side that belong to one edge.
    """

    fall: Floats
    radius: Floats
    width: Floats
    half: int

    @classmethod
    def of(cls, rims: Sequence[Rim], rays: Rays) -> _Bands:
        """Cut them out of the falls along the rays."""
        step = float(rays.radius[1] - rays.radius[0])
        half = int(np.clip(round(_EDGE_WIDTH / step), 2, 4))
        reach = [rim.radius + 4 * rim.width * np.array([-1, 1]) for rim in rims]
        ranks = [np.searchsorted(rays.radius, ends).tolist() for ends in reach]
        steps = max(last - first for first, last in ranks)
        shape = (len(rays.inside), len(rims), len(rays.angle), steps + 2 * half)
        fall = np.zeros(shape, np.float32)
        whole = bool(rays.inside.all())
        for k, (rim, (first, last)) in enumerate(zip(rims, ranks, strict=True)):
            band = fall[:, k, :, half : half + last - first]
            np.maximum(rim.fall[..., first:last], 0, out=band)
            if not whole:
                band *= rays.inside[..., first:last]
        begins = rays.radius[[first for first, _ in ranks]]
        radius = begins[:, None] + step * np.arange(steps)
        width = np.array([rim.width for rim in rims], np.float32)
        return cls(fall, np.asarray(radius, np.float32), width, half)

    def edges(self, expected: Array) -> tuple[Array, Array]:
        """Find the strongest fall near the expected radii, shape (n, circles, rays).

        Returns
        -------
        radius, strength : ndarray, shape (n, circles, rays)
            Where it lies, m, and how much falls there.
        """
        half, size = self.half, self.fall.shape[-1]
        away = self.radius[:, None] - expected[..., None].astype(np.float32)
        away /= self.width[:, None, None]
        away *= away
        away *= np.float32(-0.5)
        shape = away.shape[:-1]
        best = (self.fall[..., half : size - half] * np.exp(away, out=away)).argmax(-1).ravel()
        offsets = np.arange(2 * half + 1)
        rows = np.arange(0, self.fall.size, size)
        # Which edge is meant is told by where it is expected; where it lies, by itself alone.
        strength = self.fall.ravel().take((rows + best)[:, None] + offsets)
        best = np.clip(best + strength.argmax(1) - half, 0, size - 2 * half - 1)
        strength = self.fall.ravel().take((rows + best)[:, None] + offsets)
        total = strength @ np.ones(len(offsets), np.float32)
        place = (strength @ (offsets - half).astype(np.float32)) / np.maximum(total, 1e-9)
        step = float(self.radius[0, 1] - self.radius[0, 0])
        radius = self.radius[:, :1] + step * (place + best).reshape(shape)
        return np.asarray(radius, float), total.reshape(shape)


@lru_cache(maxsize=8)
def _design(rays: int, circles: int) -> tuple[Array, Array]:
    """Change of each edge by shift and radii, one circle after the other; products of that."""
    around = directions(rays)[1]
    design = np.concatenate(
        [np.hstack([around, np.tile(row, (rays, 1))]) for row in np.eye(circles)]
    )
    squares = design[:, :, None] * design[:, None, :]
    return design, squares.reshape(len(design), -1)


def fit_circles(
    rays: Rays,
    rims: Sequence[Rim],
    slack: float,
    reach: float,
    noise: Array,
    rounds: int = 2,
) -> Fits:
    """Fit concentric circles to the edges on rays from centres that are nearly right.

    Linear: edge ≈ R + dx cos φ + dy sin φ, robust by reweighting (Tukey's biweight), with
    the radii held near what is expected. The edges are chosen anew about each fit.

    Parameters
    ----------
    rays : Rays
        About n places.
    rims : sequence of Rim
        The circles, from the innermost to the outermost.
    slack, reach : float
        Standard deviation of the radii, and distance from the circle up to which an edge may
        count, as shares of the radius.
    noise : ndarray, shape (n,)
        Least standard error of one edge, m.
    rounds : int
        How often edges are chosen.
    """
    n, circles = len(rays.inside), len(rims)
    expected = np.array([rim.radius for rim in rims])
    design, squares = _design(len(rays.angle), circles)
    size = 2 + circles
    prior = np.zeros((n, size, size))
    prior[:, range(size), range(size)] = 1e-9
    for k, radius in enumerate(expected.tolist()):
        prior[:, 2 + k, 2 + k] += (noise / (slack * radius)) ** 2
    bands = _Bands.of(rims, rays)
    strong = np.array([rim.strength for rim in rims])[:, None]
    inside = np.concatenate([rim.inside for rim in rims], 1)
    may = np.concatenate([(rim.use & rim.inside) * rim.weight[:, None] for rim in rims], 1)
    least = reach * float(expected[-1]) + 2 * noise
    scale = np.full(n, 0.10 * float(expected[-1]))
    solution = np.zeros((n, size))
    for _ in range(rounds):
        shape = (solution @ design.T).reshape(n, circles, -1) + expected[:, None]
        edge, strength = bands.edges(shape)
        target = (edge - expected[:, None]).reshape(n, -1)
        base = may * (strength > strong).reshape(n, -1)
        for _ in range(3):
            residual = target - solution @ design.T
            w = base * np.maximum(1 - (residual / scale[:, None]) ** 2, 0) ** 2
            typical = 1.4826 * _median(np.abs(residual), w > 0)
            scale = np.maximum(np.minimum(scale, 3.5 * typical), least)
            normal = (w @ squares).reshape(n, size, size) + prior
            solution = np.linalg.solve(normal, ((w * target) @ design)[..., None])[..., 0]
    residual = target - solution @ design.T
    fits = (base > 0) & (np.abs(residual) < 0.75 * scale[:, None])
    count = fits.sum(1)
    rms = np.sqrt((residual**2 * fits).sum(1) / np.maximum(count, 1))
    normal = ((base * fits) @ squares).reshape(n, size, size) + prior
    spread = np.maximum(rms, noise) ** 2
    covariance = np.linalg.inv(normal)[:, :2, :2] * spread[:, None, None]
    agree = (fits & inside).reshape(n, circles, -1).sum(-1)
    shares = agree / np.maximum(inside.reshape(n, circles, -1).sum(-1), 1)
    radii = expected + solution[:, 2:]
    return Fits(count >= 8, solution[:, :2], radii, covariance, rms, shares)


def _median(values: Array, use: Bools) -> Array:
    """Median of the chosen values of each row; 0 where there are none."""
    ranked = np.sort(np.where(use, values, np.inf), axis=1)
    count = use.sum(1)
    middle = ranked[np.arange(len(ranked)), np.maximum(count - 1, 0) // 2]
    return np.asarray(np.where(count > 0, middle, 0.0))


def falls_along(values: Floats | Bytes) -> Floats:
    """Negative derivative along the radius, lightly smoothed, per step of the radius.

    Parameters
    ----------
    values : ndarray, shape (n, rays, radii, channels)
    """
    half = int(np.ceil(3 * _SMOOTH))
    x = np.arange(-half, half + 1, dtype=np.float32)
    slope = np.exp(-0.5 * (x / np.float32(_SMOOTH)) ** 2) * x
    slope /= (slope * x).sum()
    across = np.exp(-0.5 * (np.arange(-2, 3, dtype=np.float32) / 0.6) ** 2)
    flat = values.reshape(-1, *values.shape[-2:])
    filtered = cv2.sepFilter2D(flat, cv2.CV_32F, -slope, across / across.sum())
    return np.asarray(filtered, np.float32).reshape(values.shape)


def summed(values: Bools | Floats) -> Floats:
    """Sum over the last axis; for many short rows faster than numpy's own."""
    return np.asarray(values.astype(np.float32) @ np.ones(values.shape[-1], np.float32))
