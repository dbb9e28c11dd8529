"""Concentric circles about places on the ice, fitted to edges on rays.

All places of a picture are treated at once: every array begins with the axis of the places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.rays import Rays, directions
from curlshot.vision.detection.rims import Bands, Rim

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

WALL = 0.0, 0.004
"""Height of a cap's wall where nothing is known of it, and the standard deviation of that, m."""

BENDS = (2, 3, 4)
"""Waves around a circle by which it is told to be bent."""


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
    wall : ndarray, shape (n,)
        Height of the wall, m.
    covariance : ndarray, shape (n, 2, 2)
        Of the shift by the scatter of the edges, m².
    bends : ndarray, shape (n, 6)
        How the innermost circle is bent: the lowest harmonics of how far its edges lie off it, m.
    shares : ndarray, shape (n, circles)
        Rays that agree, of those in the picture.
    unbroken : ndarray, shape (n,)
        How far around all circles are seen on one side, as a share of the rays.
    """

    ok: Flags
    shift: Array
    radii: Array
    wall: Array
    covariance: Array
    bends: Array
    shares: Array
    unbroken: Array

    def at_places(self, index: slice) -> Fits:
        """Take those about some of the places."""
        return Fits(*(getattr(self, field.name)[index] for field in fields(self)))


@lru_cache(maxsize=8)
def _changes(rays: int, circles: int) -> Array:
    """Change of each edge, one circle after the other, by shift, radii and wall."""
    around = directions(rays)[1]
    rows = [np.hstack([around, np.tile(row, (rays, 1))]) for row in np.eye(circles, circles + 1)]
    return np.concatenate(rows).T


@dataclass(frozen=True)
class _Design:
    """How edges change with the unknowns of each of n places: shift (2), radii, wall.

    Attributes
    ----------
    change : ndarray, shape (n, unknowns, edges)
    """

    change: Array

    @classmethod
    def of(cls, rims: Sequence[Rim]) -> _Design:
        """Design of concentric circles."""
        n, rays = rims[0].use.shape
        change = np.tile(_changes(rays, len(rims)), (n, 1, 1))
        for k, rim in enumerate(rims):
            if rim.lean is not None:
                change[:, -1, k * rays : (k + 1) * rays] = rim.lean
        return cls(change)

    @property
    def lean(self) -> Array:
        """Change of the edges by the wall, shape (n, edges)."""
        return self.change[:, -1]

    def edges(self, unknowns: Array) -> Array:
        """Change of the edges, (n, edges), by unknowns, (n, unknowns)."""
        return np.asarray((unknowns[:, None] @ self.change)[:, 0])

    def normal(self, weight: Array) -> Array:
        """Matrices of the normal equations, shape (n, unknowns, unknowns)."""
        return np.asarray((self.change * weight[:, None]) @ np.swapaxes(self.change, 1, 2))

    def solve(self, weight: Array, edges: Array, prior: Array) -> Array:
        """Unknowns by which edges change so, (n, edges), by weighted least squares."""
        right = self.change @ (weight * edges)[..., None]
        return np.asarray(np.linalg.solve(self.normal(weight) + prior, right)[..., 0])


def fit_circles(
    rays: Rays,
    rims: Sequence[Rim],
    slack: float,
    reach: float,
    noise: Array,
    rounds: int = 2,
    wall: tuple[float, float | Array] = WALL,
) -> Fits:
    """Fit concentric circles to the edges on rays from centres that are nearly right.

    Linear: edge ≈ R + dx cos φ + dy sin φ + wall · lean, robust by reweighting (Tukey's
    biweight), with the radii and the wall held near what is expected. The edges are chosen anew
    about each fit. Whether there are such circles is asked of all alike; where they lie, of each
    as far as its edges say (`Rim.say`).

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
    wall : tuple of float
        Expected height of the wall, and the standard deviation of that, m; of all places or each.
    """
    n, circles = len(rays.inside), len(rims)
    expected = np.array([rim.radius for rim in rims])
    design = _Design.of(rims)
    prior = _held(expected, noise, slack, wall[1])
    bands = Bands.of(rims, rays)
    strong = np.array([rim.strength for rim in rims])[:, None]
    inside = np.concatenate([rim.inside for rim in rims], 1)
    may = np.concatenate([(rim.use & rim.inside) * rim.weight[:, None] for rim in rims], 1)
    least = reach * float(expected[-1]) + 2 * noise
    scale = np.full(n, 0.10 * float(expected[-1]))
    usual = np.repeat(expected, len(rays.angle)) + wall[0] * design.lean
    change: Array = np.zeros_like(design.lean)
    solution: Array = np.zeros(prior.shape[:2])
    for _ in range(rounds):
        edge, strength = bands.edges((usual + change).reshape(n, circles, -1))
        target = edge.reshape(n, -1) - usual
        base = may * (strength > strong).reshape(n, -1)
        residual = target - change
        for _ in range(3):
            w = base * _likely(residual, scale)
            typical = 1.4826 * medians(np.abs(residual), w > 0)
            scale = np.maximum(np.minimum(scale, 3.5 * typical), least)
            solution = design.solve(w, target, prior)
            change = design.edges(solution)
            residual = target - change
    agree = (_inlying(base, residual, scale) & inside).reshape(n, circles, -1)
    shares = agree.sum(-1) / np.maximum(inside.reshape(n, circles, -1).sum(-1), 1)
    # From here on circles that are known to lie aside have less of a say.
    base *= np.repeat([rim.say for rim in rims], len(rays.angle))
    for _ in range(2):
        solution = design.solve(base * _likely(residual, scale), target, prior)
        residual = target - design.edges(solution)
    fits = _inlying(base, residual, scale)
    count = fits.sum(1)
    rms = np.sqrt((residual**2 * fits).sum(1) / np.maximum(count, 1))
    innermost = slice(len(rays.angle))
    return Fits(
        ok=count >= 8,
        shift=solution[:, :2],
        radii=expected + solution[:, 2:-1],
        wall=wall[0] + solution[:, -1],
        covariance=_covariance(design.normal(base * fits), prior, np.maximum(rms, noise)),
        bends=_bends(residual[:, innermost], fits[:, innermost]),
        shares=shares,
        unbroken=_unbroken(agree.all(1)),
    )


def _held(radii: Array, noise: Array, slack: float, wall_sd: float | Array) -> Array:
    """Weights that hold radii and wall near what is expected, shape (n, unknowns, unknowns)."""
    size = 3 + len(radii)
    prior = np.zeros((len(noise), size, size))
    prior[:, range(size), range(size)] = 1e-9
    for k, radius in enumerate(radii.tolist()):
        prior[:, 2 + k, 2 + k] += (noise / (slack * radius)) ** 2
    prior[:, -1, -1] += (noise / wall_sd) ** 2
    return prior


def _inlying(weight: Array, residual: Array, scale: Array) -> Flags:
    """Which of the edges that count lie on the circles, shape (n, edges)."""
    return np.asarray((weight > 0) & (np.abs(residual) < 0.75 * scale[:, None]))


def _covariance(normal: Array, prior: Array, sd: Array) -> Array:
    """Covariance of the centres, (n, 2, 2), m², where each edge errs by `sd`, (n,).

    What is held near its usual value errs, but not anew in each picture.
    """
    spread = np.linalg.inv(normal + prior)
    covariance = (spread @ normal @ spread)[:, :2, :2]
    return np.asarray(covariance * (sd**2)[:, None, None])


def _likely(residual: Array, scale: Array) -> Array:
    """Tukey's biweight of residuals, (n, edges), by the scale at each place."""
    return np.asarray(np.maximum(1 - (residual / scale[:, None]) ** 2, 0) ** 2)


def _unbroken(agree: Flags) -> Array:
    """Most that rays agree along one arc less those that do not, as a share of all, shape (n,).

    The largest sum of neighbours on a ring (Kadane): one that does not pass the seam, or all less
    the smallest.
    """
    total = np.zeros((len(agree), agree.shape[1] + 1))
    np.cumsum(2.0 * agree - 1, axis=1, out=total[:, 1:])
    most = (total - np.minimum.accumulate(total, axis=1)).max(1)
    least = (total - np.maximum.accumulate(total, axis=1)).min(1)
    return np.asarray(np.maximum(most, total[:, -1] - least) / agree.shape[1])


@lru_cache(maxsize=8)
def _harmonics(rays: int) -> Array:
    """Cosines and sines of 2, 3 and 4 times the angle of rays, shape (rays, 6)."""
    turns = np.outer(directions(rays)[0], BENDS)
    return np.concatenate([np.cos(turns), np.sin(turns)], 1)


def _bends(residual: Array, use: Flags) -> Array:
    """Harmonics of what edges lie off a circle, (n, rays), by those that are used."""
    count = np.maximum(use.sum(1), 1)
    return np.asarray(2 * (residual * use) @ _harmonics(residual.shape[1]) / count[:, None])


def medians(values: Array | NDArray[np.float32], use: Flags) -> Array:
    """Median of the chosen values of each row, shape (n, m); 0 where there are none."""
    ranked = np.where(use, values, np.inf)
    ranked.sort(axis=1)
    count = use.sum(1)
    middle = ranked[np.arange(len(ranked)), np.maximum(count - 1, 0) // 2]
    return np.asarray(np.where(count > 0, middle, 0.0))
