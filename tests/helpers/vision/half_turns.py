"""What tests of half turns share."""

from __future__ import annotations

import numpy as np

from curlshot.vision.spin.align import ORDERS

RNG = np.random.default_rng(3)
BAR = np.where(ORDERS % 2 == 0, np.exp(-((ORDERS / 6.0) ** 2)), 0.0)
CLOSE = 0.1
"""To what a path tells angles, rad: half of how far apart those that are tried are, and more."""


def pictures(angles: np.ndarray, lit: float = 0.0, noise: float = 0.02) -> np.ndarray:
    """Pictures of a bar alike at both ends; of its odd harmonics light has the other sign."""
    odd = np.where(ORDERS % 2 == 1, lit * np.exp(-((ORDERS / 6.0) ** 2)), 0.0)
    turned = (BAR + odd * np.sign(np.cos(angles))[:, None]) * np.exp(-1j * ORDERS * angles[:, None])
    each = np.repeat(turned, 24, axis=1).reshape(len(angles), len(ORDERS), 8, 3)
    grain = RNG.normal(0, noise, (2, *each.shape))
    return np.asarray(each + grain[0] + 1j * grain[1], np.complex64)


def error(found: np.ndarray, true: np.ndarray) -> float:
    """Largest difference but for what all have in common."""
    off = found - true
    return float(np.nanmax(np.abs(off - np.nanmedian(off))))
