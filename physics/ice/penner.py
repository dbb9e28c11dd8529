"""Friction that falls with the root of the speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import GRAVITY
from curlshot.physics.registry import parameter


@dataclass(frozen=True)
class Penner:
    """Friction that falls with the root of the speed, μ(v) = μ1 (v / 1 m/s)^(-1/2).

    Source: Penner, 2001, Am. J. Phys. 69, 332.

    Attributes
    ----------
    friction : float
        Coefficient at 1 m/s.

    Examples
    --------
    >>> import curlshot
    >>> round(float(curlshot.Penner(0.008).deceleration(4.0)), 4)
    0.0392
    """

    friction: float = parameter(0.008, 1e-4, 1.0)
    name = "penner"

    def deceleration(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Deceleration μ(v) g, m/s²; `speed` must be positive."""
        return np.asarray(self.friction * GRAVITY / np.sqrt(np.asarray(speed, float)))

    def scaled(self, factor: float) -> Penner:
        """Return the law with all its friction multiplied by a factor."""
        return Penner(factor * self.friction)
