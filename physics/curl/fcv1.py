"""Curl of the simulator Digital Curling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.physics.registry import parameter


@dataclass(frozen=True)
class FCV1Curl:
    """Curl of the FCV1 model: a counter-clockwise stone curls to its left.

    dφ/dt = sign(ω) turn (v / 1 m/s)^(-0.8), dω/dt = -sign(ω) loss / max(v, slow).
    Source: Uehara and Ito, 2021, the default of the simulator Digital Curling.

    Attributes
    ----------
    turn : float
        Turning of the path at 1 m/s, rad/s.
    loss : float
        Loss of spin times speed, m rad/s³.
    slow : float
        Speed below which the loss of spin no longer grows, m/s.

    Examples
    --------
    >>> import curlshot
    >>> round(float(curlshot.FCV1Curl().turn_rate(1.0)), 4)
    0.0082
    """

    turn: float = parameter(0.00820, 0.0, 1.0)
    loss: float = parameter(0.025, 0.0, 10.0)
    slow: float = parameter(0.001, 1e-6, 1.0)
    name = "fcv1"

    def turn_rate(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Return the turning of the path, rad/s; `speed` must be positive."""
        return np.asarray(self.turn * np.asarray(speed, float) ** -0.8)

    def spin_loss(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Loss of |spin|, rad/s²."""
        return np.asarray(self.loss / np.maximum(np.asarray(speed, float), self.slow))
