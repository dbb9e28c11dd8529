"""Friction as measured: the family of laws that a shot's own glides are fitted with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.data.sheet import GRAVITY
from curlshot.physics.registry import parameter


@dataclass(frozen=True)
class Fit:
    """Friction with a part that fades with the speed, μ(v) = a / (v + v_c) + b.

    The form of FCV1 (Uehara and Ito, 2021) with constants to be found; a = 0 makes it
    constant.

    Attributes
    ----------
    a, v_c, b : float
        Constants of the law: m/s (0 to 0.01 on real ice), m/s and a pure number
        (0.003 to 0.012).
    """

    a: float = parameter(0.002, 0.0, 1.0)
    v_c: float = parameter(0.064, 1e-3, 10.0)
    b: float = parameter(0.0063, 1e-4, 1.0)
    name = "fit"

    def deceleration(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Deceleration μ(v) g, m/s²."""
        friction = self.a / (np.asarray(speed, float) + self.v_c) + self.b
        return np.asarray(friction * GRAVITY)

    def scaled(self, factor: float) -> Fit:
        """Return the law with all its friction multiplied by a factor."""
        return Fit(factor * self.a, self.v_c, factor * self.b)
