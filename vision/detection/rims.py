"""Where something ends on rays about places on the ice: edges near the circles expected there.

All places of a picture are treated at once: every array begins with the axis of the places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.rays import Rays

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Flags = NDArray[np.bool_]

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
        What an edge at each place counts.
    say : float
        What an edge says of where the centre is, beside those of the other circles.
    lean : ndarray, shape (n, rays), optional
        How far the edge lies beyond the circle per metre of the wall below it: where a slanting
        view shows the wall, what ends there is its foot. None where there is no wall.
    """

    fall: Floats
    use: Flags
    inside: Flags
    radius: float
    width: float
    strength: float
    weight: Array
    say: float = 1.0
    lean: Array | None = None

    def at_places(self, index: NDArray[np.intp]) -> Rim:
        """Take those about some of the places."""
        lean = None if self.lean is None else self.lean[index]
        return replace(
            self, fall=self.fall[index], use=self.use[index], inside=self.inside[index],
            weight=self.weight[index], lean=lean,
        )  # fmt: skip


@dataclass(frozen=True)
class Bands:
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
    def of(cls, rims: Sequence[Rim], rays: Rays) -> Bands:
        """Cut them out of the falls along the rays."""
        step = float(rays.radius[1] - rays.radius[0])
        half = min(max(round(_EDGE_WIDTH / step), 2), 4)
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
        away = np.exp(away, out=away)
        away *= self.fall[..., half : size - half]
        best = away.argmax(-1).ravel()
        offsets = np.arange(2 * half + 1)
        rows = np.arange(0, self.fall.size, size)
        # Which edge is meant is told by where it is expected; where it lies, by itself alone.
        strength = self.fall.ravel().take((rows + best)[:, None] + offsets)
        best = np.minimum(np.maximum(best + strength.argmax(1) - half, 0), size - 2 * half - 1)
        strength = self.fall.ravel().take((rows + best)[:, None] + offsets)
        total = strength @ np.ones(len(offsets), np.float32)
        place = (strength @ (offsets - half).astype(np.float32)) / np.maximum(total, 1e-9)
        step = float(self.radius[0, 1] - self.radius[0, 0])
        radius = self.radius[:, :1] + step * (place + best).reshape(shape)
        return np.asarray(radius, float), total.reshape(shape)


def falls_along(values: Floats | Bytes) -> Floats:
    """Negative derivative along the radius, lightly smoothed, per step of the radius.

    Parameters
    ----------
    values : ndarray, shape (n, rays, radii, channels)
    """
    if not values.size:
        return np.zeros(values.shape, np.float32)
    flat = values.reshape(-1, *values.shape[-2:])
    filtered = cv2.sepFilter2D(flat, cv2.CV_32F, *_kernels())
    return np.asarray(filtered, np.float32).reshape(values.shape)


@lru_cache(maxsize=1)
def _kernels() -> tuple[Floats, Floats]:
    """Weights along the radius, by which values fall, and across the rays."""
    half = int(np.ceil(3 * _SMOOTH))
    x = np.arange(-half, half + 1, dtype=np.float32)
    slope = np.exp(-0.5 * (x / np.float32(_SMOOTH)) ** 2) * x
    slope /= (slope * x).sum()
    across = np.exp(-0.5 * (np.arange(-2, 3, dtype=np.float32) / 0.6) ** 2)
    return -slope, across / across.sum()


def summed(values: Flags | Floats) -> Floats:
    """Sum over the last axis; for many short rows faster than numpy's own."""
    return np.asarray(values.astype(np.float32) @ np.ones(values.shape[-1], np.float32))
