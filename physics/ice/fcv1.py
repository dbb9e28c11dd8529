"""Friction of the simulator Digital Curling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.physics.registry import parameter


@dataclass(frozen=True)
class FCV1:
    """Friction of the FCV1 model, μ(v) = a / (v + v_c) + b.

    Source: Uehara and Ito, 2021, the default of the simulator Digital Curling.

    Attributes
    ----------
    a, v_c, b : float
        Constants of the law: m/s, m/s and a pure number.
    gravity : float
        Free fall, m/s². The simulator has 9.80665, but its steps of 1 ms in single precision
        let a stone stop up to 3 mm sooner in 62 m; with 9.807 the exact motion ends within
        1.1 mm of where it does.

    Examples
    --------
    >>> import curlshot
    >>> round(float(curlshot.FCV1().deceleration(1.0)), 4)
    0.0799
    """

    a: float = parameter(0.00200985, 0.0, 1.0)
    v_c: float = parameter(0.06385782, 1e-3, 10.0)
    b: float = parameter(0.00626286, 1e-4, 1.0)
    gravity: float = parameter(9.807, 1.0, 30.0)
    name = "fcv1"

    def deceleration(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Deceleration μ(v) g, m/s²."""
        friction = self.a / (np.asarray(speed, float) + self.v_c) + self.b
        return np.asarray(friction * self.gravity)

    def scaled(self, factor: float) -> FCV1:
        """Return the law with all its friction multiplied by a factor."""
        return FCV1(factor * self.a, self.v_c, factor * self.b, self.gravity)
