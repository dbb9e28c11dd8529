"""Points on the ice by which cameras are compared."""

from __future__ import annotations

import numpy as np

_ANGLE = np.arange(16) * np.pi / 8
RINGS = np.concatenate(
    [r * np.stack([np.cos(_ANGLE), np.sin(_ANGLE)], axis=-1) for r in (1.829, 1.219, 0.61)]
)
"""Of the three rings, shape (48, 2)."""
