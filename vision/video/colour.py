"""Colours in CIE L*a*b*, 8 bits each: L* scaled to 255, a* and b* shifted by 128.

What OpenCV gives, within one step: before its first colour it works out tables for as long as
it takes to decode twenty frames.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Floats = NDArray[np.float32]

_STEPS = 4096
"""Steps from black to white in which the cube root is tabulated."""

_AT_ONCE = 8192
"""So many colours at once stay in the processor's cache."""

_FROM_BGR = np.array(
    [[0.180423, 0.357580, 0.412453], [0.072169, 0.715160, 0.212671], [0.950227, 0.119193, 0.019334]]
)
_FROM_BGR /= _FROM_BGR.sum(1, keepdims=True)
"""From linear blue, green and red to X, Y and Z as shares of white (ITU-R BT.709, D65)."""

_TO_STEPS = np.column_stack([_FROM_BGR * _STEPS, [0.5] * 3])

_TO_LAB = np.array(
    [[0.0, 295.8, 0.0, -40.8], [500.0, -500.0, 0.0, 128.0], [0.0, 200.0, -200.0, 128.0]]
)
"""From the (tabulated) roots of these and 1 to the three numbers."""


@lru_cache(maxsize=1)
def _tables() -> tuple[Floats, Floats]:
    """Linear light by what is coded (IEC 61966-2-1), and the root of CIE 15 in `_STEPS`."""
    coded = np.arange(256) / 255
    light = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    share = np.arange(_STEPS + 2) / _STEPS
    root = np.where(share > 216 / 24389, np.cbrt(share), (24389 / 27 * share + 16) / 116)
    return light.astype(np.float32)[None], root.astype(np.float32)


def lab_of(bgr: Bytes) -> Bytes:
    """L*a*b* of colours, shape (..., rows, 3), of blue, green and red."""
    light, root = _tables()
    flat = bgr.reshape(1, -1, 3)
    out = np.empty_like(flat)
    for begin in range(0, flat.shape[1], _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        share = cv2.transform(cv2.LUT(flat[:, part], light), _TO_STEPS)
        out[:, part] = cv2.convertScaleAbs(
            cv2.transform(root.take(share.astype(np.uint16)), _TO_LAB)
        )
    return out.reshape(bgr.shape)


def chroma(lab: Array | Floats) -> Array:
    """How far colours in L*a*b*, not as whole bytes, shape (..., 3), are from grey, shape (...)."""
    return np.asarray(np.hypot(lab[..., 1] - 128, lab[..., 2] - 128))


def bgr_of(lab: Array) -> tuple[int, int, int]:
    """Blue, green and red of a colour in L*a*b*; the nearest where there is none."""
    root = np.linalg.solve(_TO_LAB[:, :3], np.asarray(lab, float) - _TO_LAB[:, 3])
    share = np.where(root > 6 / 29, root**3, (116 * root - 16) * 27 / 24389)
    linear = np.clip(np.linalg.solve(_FROM_BGR, share), 0, 1)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    blue, green, red = np.rint(255 * coded).astype(int).tolist()
    return blue, green, red
