"""Friction that does not depend on the speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import GRAVITY
from curlshot.physics.registry import parameter


@dataclass(frozen=True)
class Constant:
    """Coulomb friction, a = μ g.

    Attributes
    ----------
    friction : float
        Coefficient μ; 0.0109 is what the study of the 2018 Olympic final found.

    Examples
    --------
    >>> import curlshot
    >>> round(float(curlshot.Constant(0.01).deceleration(1.0)), 4)
    0.0981
    """

    friction: float = parameter(0.0109, 1e-4, 1.0)
    name = "constant"

    def deceleration(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Deceleration μ g, m/s², of the shape of `speed`."""
        return np.full_like(np.asarray(speed, float), self.friction * GRAVITY)

    def scaled(self, factor: float) -> Constant:
        """Return the law with all its friction multiplied by a factor."""
        return Constant(factor * self.friction)
