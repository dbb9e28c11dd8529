"""Pictures of tilted ice as if seen from straight above, where circles are round.

By a camera of a usual focal length; no tilt that is tried is quite that of the ice, so what is left
of it is told by rings themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FOCAL = 2.0
"""Usual focal length, in longer sides of the picture: with it a circle's near half looks larger."""

NEAR, FACING = (0.1, 0.07, 0.05), 0.9
"""How near to a ring edges must be to tell its shape, in radii of the largest, time after time; and
the cosine of the angle by which their gradients may point aside."""

LEAST_EDGES = 20
"""Edges that tell the shape of rings."""

HELD = np.array([1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 3.0])
"""How firmly rings are held where they are (along x and y, size) and round (two ways, and nearer
parts larger along x and y): as many edges at once would hold them."""


@dataclass(frozen=True)
class Tilt:
    """How ice in a picture is tilted, and how to see it level.

    Attributes
    ----------
    stretch : ndarray, shape (2, 2)
        What the tilt has squashed is stretched by it, about the middle of the picture.
    fall : ndarray, shape (2,)
        By how much what is nearer looks larger, per px.
    size : tuple of int
        Width and height of the picture, px.
    """

    stretch: Array
    fall: Array
    size: tuple[int, int]

    @classmethod
    def of(cls, squash: float, lean: float, size: tuple[int, int]) -> Tilt:
        """Tilt that makes circles `squash` as high as wide, the short axis leaning, rad."""
        short = np.array([np.sin(lean), np.cos(lean)])
        stretch = np.eye(2) + (1 / squash - 1) * np.outer(short, short)
        return cls(stretch, short * np.sqrt(1 / squash**2 - 1) / (FOCAL * max(size)), size)

    def level(self, points: Array) -> Array:
        """See places of the picture, shape (n, 2), from above, from its middle on."""
        off = points - self._middle
        return np.asarray(off @ self.stretch.T / (1 + off @ self.fall)[:, None])

    def level_edges(self, points: Array, gradients: Array) -> tuple[Array, Array]:
        """See edges from above: their places and unit gradients, shape (n, 2) each."""
        seen = self.level(points)
        # Gradients go by the inverse of the change of places, transposed.
        (a, b), (c, d) = self.stretch[:, :, None] - seen.T[:, None] * self.fall[:, None]
        gx, gy = gradients.T
        across, down = d * gx - c * gy, a * gy - b * gx
        return seen, np.stack([across, down], -1) / np.hypot(across, down)[:, None]

    def pictured(self, seen: Array) -> Array:
        """Where the picture has what is seen from above, shape (..., 2), px."""
        off = seen @ np.linalg.inv(self.stretch).T
        return np.asarray(self._middle + off / (1 - off @ self.fall)[..., None])

    @property
    def _middle(self) -> Array:
        return (np.array(self.size) - 1) / 2


@dataclass(frozen=True)
class Rounding:
    """What makes circles about 0 of rings in a picture.

    Attributes
    ----------
    tilt : Tilt
        Of the ice.
    centre : ndarray, shape (2,)
        Of the rings, seen from above.
    shape : ndarray, shape (2, 2)
        What makes them of circles there.
    """

    tilt: Tilt
    centre: Array
    shape: Array = field(default_factory=lambda: np.eye(2))

    def of_edges(self, points: Array, gradients: Array) -> tuple[Array, Array]:
        """Where edges seen from above are as the rings are round, and their unit gradients."""
        across, down = (gradients @ self.shape).T
        off = (points - self.centre) @ np.linalg.inv(self.shape).T
        return off, np.stack([across, down], -1) / np.hypot(across, down)[:, None]

    def pictured(self, places: Array) -> Array:
        """Where the picture has places about the rings as they are round, shape (..., 2), px."""
        return self.tilt.pictured(self.centre + places @ self.shape.T)


def rounded(points: Array, gradients: Array, seen: Rounding, radii: Array) -> Rounding:
    """Make rings rounder by the edges near them, by robust least squares.

    Parameters
    ----------
    points, gradients : ndarray, shape (n, 2)
        Edges seen from above, and unit gradients there.
    seen : Rounding
        Which makes the rings nearly round.
    radii : ndarray
        Theirs, the largest first, px.
    """
    size, shares = float(radii[0]), radii / radii[0]
    for near in NEAR:
        off, normal = seen.of_edges(points, gradients)
        r = np.hypot(off[:, 0], off[:, 1])
        which = np.abs(r[:, None] - radii).argmin(1)
        beyond, share = (r - radii[which]) / size, shares[which]
        use = (np.abs(beyond) < near) & (np.abs((off * normal).sum(1)) > FACING * r)
        if use.sum() < LEAST_EDGES:
            break
        (x, y), share, beyond = (off[use] / r[use, None]).T, share[use], beyond[use]
        wide, aslant, nearer = share * (x * x - y * y), share * 2 * x * y, share**2
        change = np.stack([x, y, share, wide, aslant, nearer * x, nearer * y])
        weight = np.ones(len(beyond))
        for _ in range(3):
            normal = (weight * change) @ change.T + np.diag(HELD)
            found = np.linalg.solve(normal, change @ (weight * beyond))
            left = beyond - found @ change
            weight = 1 / (1 + (left / (1.5 * np.median(np.abs(left)) + 0.3 / size)) ** 2)
        larger, wider, turned = found[2:5].tolist()
        centre = seen.centre + size * seen.shape @ found[:2]
        bend = np.array([[1 + larger + wider, turned], [turned, 1 + larger - wider]])
        seen = Rounding(seen.tilt, centre, seen.shape @ bend)
    return seen
