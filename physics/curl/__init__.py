"""How a stone's path turns: one module per law, found by its name (`curlshot.physics.registry`)."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.physics.curl.fcv1 import FCV1Curl
from curlshot.physics.curl.none import NoCurl

__all__ = ["Curl", "FCV1Curl", "NoCurl"]


class Curl(Protocol):
    """How a stone's path turns and how its spin is lost; frozen like `physics.ice.IceLaw`."""

    def __hash__(self) -> int: ...

    @property
    def name(self) -> str:
        """Name of the law, as in files."""
        ...

    def turn_rate(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Return the turning of the path at `speed` > 0 for a counter-clockwise spin, rad/s.

        A clockwise stone turns as fast the other way, one without spin goes straight.
        """
        ...

    def spin_loss(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Loss of |spin| at `speed` >= 0, rad/s², not negative."""
        ...
