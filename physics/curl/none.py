"""No curl at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class NoCurl:
    """Straight paths; the spin is kept until the stone stops.

    Examples
    --------
    >>> import curlshot
    >>> float(curlshot.NoCurl().turn_rate(1.0))
    0.0
    """

    name = "none"

    def turn_rate(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Zero, rad/s."""
        return np.zeros_like(np.asarray(speed, float))

    def spin_loss(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Zero, rad/s²."""
        return np.zeros_like(np.asarray(speed, float))
