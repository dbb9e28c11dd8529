"""What tests of breaks share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

T = np.arange(0, 4, 1 / 30)


def seen(y: NDArray[np.float64], sd: float, seed: int = 0) -> NDArray[np.float64]:
    """Places of a stone that goes up y, with white errors."""
    rng = np.random.default_rng(seed)
    return np.column_stack([np.zeros_like(y), y]) + rng.normal(0, sd, (len(y), 2))
