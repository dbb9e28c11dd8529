"""What lens and shutter mix: codes as they are, or the light that they stand for.

Light is nearly a power of 2.2 of its code (ITU-R BT.709); power 1 is codes. Both go from 0 to 255.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.floating[Any]]


def lit(codes: NDArray[np.uint8], power: float) -> Field:
    """Give what is mixed of a picture or of colours."""
    table = 255 * (np.arange(256) / 255) ** power
    return np.asarray(cv2.LUT(codes, table.astype(np.float32)), np.float32)


def coded(mixed: Field, power: float) -> Field:
    """Give the codes of what was mixed."""
    if power == 1:
        return mixed
    return np.asarray(255 * (np.clip(mixed, 0, None) / 255) ** np.float32(1 / power), np.float32)
