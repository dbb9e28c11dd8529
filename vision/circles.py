"""Circles about a place on the ice: rays sampled in the picture itself, edges, and their fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.camera import Camera
from vision.clip import Image
from vision.ice_map import lifted

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rays:
    """Colours on rays around candidates, from the picture itself."""

    bgr: Image  # (n, rays, radii, 3)
    lab: NDArray[np.uint8]  # the same in L*a*b*
    inside: NDArray[np.bool_]  # (n, rays, radii)
    radius: Array  # (radii,)
    angle: Array  # (rays,)

    def at(self, index: int, radius: float) -> NDArray[np.bool_]:
        """Which rays of a candidate show the place at this radius, shape (rays,)."""
        return np.asarray(self.inside[index][:, np.searchsorted(self.radius, radius)])


def sample_rays(
    image: Image, camera: Camera, places: Array, radius: Array, height: Array, rays: int
) -> Rays:
    """Sample the picture on rays around places on the ice.

    Parameters
    ----------
    places : ndarray, shape (n, 2)
        Centres, m.
    radius, height : ndarray, shape (radii,)
        Distances from the centre, and how high above the ice what is seen there lies, m.
    rays : int
        How many, counter-clockwise from the x axis.
    """
    angle = np.arange(rays) * (2 * np.pi / rays)
    around = np.stack([np.cos(angle), np.sin(angle)], -1)[:, None] * radius[None, :, None]
    ice = lifted(camera, places[:, None, None] + around, height)
    pixels = camera.project(ice)
    width, high = camera.size
    inside = (pixels >= 0).all(-1) & (pixels[..., 0] <= width - 1) & (pixels[..., 1] <= high - 1)
    flat = pixels.reshape(-1, len(radius), 2).astype(np.float32)
    most = 32000  # as many as cv2.remap takes at once
    parts = [
        cv2.remap(image, part[..., 0], part[..., 1], cv2.INTER_LINEAR)
        for part in np.split(flat, range(most, len(flat), most))
    ]
    bgr = np.asarray(np.concatenate(parts), np.uint8)
    lab = np.asarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2LAB), np.uint8)
    shape = (*inside.shape, 3)
    return Rays(
        bgr.reshape(shape),
        lab.reshape(shape),
        np.asarray(inside),
        np.asarray(radius),
        np.asarray(angle),
    )


def _edge(
    fall: Array, seen: NDArray[np.bool_], radius: Array, expected: Array, width: float
) -> tuple[Array, Array]:
    """Place of the strongest fall near the expected radius on each ray, and its strength.

    Parameters
    ----------
    fall : ndarray, shape (rays, radii)
        How much the signal falls per step of the radius.
    expected : ndarray, shape (rays,)
        Where the edge should be, m; `width` is the standard deviation of that.
    """
    step = radius[1] - radius[0]
    prior = np.exp(-0.5 * ((radius - expected[:, None]) / width) ** 2)
    weighted = np.where(seen, np.maximum(fall, 0) * prior, 0)
    best = weighted.argmax(1)
    rows = np.arange(len(best))
    near = np.clip(best[:, None] + np.arange(-4, 5), 0, len(radius) - 1)
    strength = np.maximum(fall[rows[:, None], near], 0)
    total = strength.sum(1)
    place = (strength * near).sum(1) / np.maximum(total, 1e-9)
    return radius[0] + step * place, np.where(seen[rows, best], total, 0)


@dataclass(frozen=True)
class Rim:
    """One of the concentric circles that are sought: what falls there, and where it may."""

    fall: Array  # (rays, radii)
    use: NDArray[np.bool_]  # (rays,): rays that may show it
    inside: NDArray[np.bool_]  # (rays,): rays on which the picture shows that place
    radius: float
    width: float
    strength: float  # least that an edge falls by
    weight: float = 1.0


@dataclass(frozen=True)
class Fit:
    """Concentric circles through edge points: shift of the centre, radii, and how well."""

    shift: Array  # (2,)
    radii: Array  # one per circle
    covariance: Array  # of the shift, (2, 2)
    rms: float
    shares: Array  # one per circle: rays that agree, of those in the picture


def fit_circles(
    rays: Rays,
    index: int,
    rims: Sequence[Rim],
    slack: float,
    reach: float,
    noise: float,
    rounds: int = 2,
) -> Fit | None:
    """Fit concentric circles to the edges on rays from a centre that is nearly right.

    Linear: edge ≈ R + dx cos φ + dy sin φ, robust by reweighting (Tukey's biweight), with
    the radii held near what is expected. The edges are chosen anew about each fit.

    Parameters
    ----------
    slack, reach : float
        Standard deviation of the radii, and distance from the circle up to which an edge may
        count, as shares of the radius.
    noise : float
        Least standard error of one edge, m.
    rounds : int
        How often edges are chosen.
    """
    circles = len(rims)
    expected = np.array([rim.radius for rim in rims])
    inside = np.stack([rim.inside for rim in rims])
    around = np.stack([np.cos(rays.angle), np.sin(rays.angle)], 1)
    design = np.concatenate(
        [np.hstack([around, np.tile(row, (len(around), 1))]) for row in np.eye(circles)]
    )
    prior = np.zeros((2 + circles, 2 + circles))
    prior[2:, 2:] = np.diag((noise / (slack * expected)) ** 2)
    prior += 1e-9 * np.eye(2 + circles)
    least = reach * float(expected[-1]) + 2 * noise
    scale = 0.10 * float(expected[-1])
    solution = np.zeros(2 + circles)
    for _ in range(rounds):
        shape = (design @ solution).reshape(circles, -1) + expected[:, None]
        found = [
            _edge(rim.fall, rays.inside[index], rays.radius, curve, rim.width)
            for rim, curve in zip(rims, shape, strict=True)
        ]
        target = np.concatenate(
            [edge - rim.radius for rim, (edge, _) in zip(rims, found, strict=True)]
        )
        base = np.concatenate(
            [
                rim.use & rim.inside & (strength > rim.strength)
                for rim, (_, strength) in zip(rims, found, strict=True)
            ]
        ).astype(float)
        base *= np.repeat([rim.weight for rim in rims], len(around))
        for _ in range(3):
            residual = target - design @ solution
            w = base * np.clip(1 - (residual / scale) ** 2, 0, None) ** 2
            if (w > 0).sum() < 8:
                return None
            scale = max(min(scale, 3.5 * 1.4826 * float(np.median(np.abs(residual[w > 0])))), least)
            weighted = design.T * w
            solution = np.linalg.solve(weighted @ design + prior, weighted @ target)
    residual = target - design @ solution
    fits = (base > 0) & (np.abs(residual) < 0.75 * scale)
    if fits.sum() < 8:
        return None
    rms = float(np.sqrt(np.mean(residual[fits] ** 2)))
    normal = (design[fits].T * base[fits]) @ design[fits] + prior
    covariance = np.linalg.inv(normal)[:2, :2] * max(rms, noise) ** 2
    shares = (fits.reshape(circles, -1) & inside).sum(1) / np.maximum(inside.sum(1), 1)
    return Fit(solution[:2], expected + solution[2:], covariance, rms, shares)


def falls_along(lab: NDArray[np.uint8]) -> Array:
    """Negative derivative of colours along the rays, lightly smoothed, per step of the radius.

    Shape (rays, radii, 3) as given; the derivative of a Gaussian of 1.6 steps.
    """
    x = np.arange(-5, 6, dtype=np.float32)
    gauss = np.exp(-0.5 * (x / 1.6) ** 2)
    slope = gauss * x
    slope /= (slope * x).sum()
    across = np.exp(-0.5 * (np.arange(-2, 3, dtype=np.float32) / 0.6) ** 2)
    return np.asarray(cv2.sepFilter2D(lab, cv2.CV_32F, -slope, across / across.sum()), float)


def share_of_samples(hit: NDArray[np.bool_], inside: NDArray[np.bool_]) -> Array:
    """Share of the samples of each ray that hit, of those inside the picture."""
    return np.asarray((hit & inside).sum(1) / np.maximum(inside.sum(1), 1))
