"""How the ice slows a stone: one module per law, found by its name (`physics.registry`)."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from curlshot.physics.ice.constant import Constant
from curlshot.physics.ice.fcv1 import FCV1
from curlshot.physics.ice.fit import Fit
from curlshot.physics.ice.penner import Penner

__all__ = ["FCV1", "Constant", "Fit", "IceLaw", "Penner"]


class IceLaw(Protocol):
    """How the ice slows a stone; laws are frozen dataclasses, hashable and alike by value."""

    def __hash__(self) -> int: ...

    @property
    def name(self) -> str:
        """Name of the law, as in files."""
        ...

    def deceleration(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Deceleration against the motion at `speed` > 0 (m/s), in m/s², positive."""
        ...

    def scaled(self, factor: float) -> IceLaw:
        """Return the law with all its friction multiplied by a factor."""
        ...
