"""What tests of inclined share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.tests.helpers.vision.handles import RADII
from curlshot.tests.helpers.vision.steep_handles import TIMES, TRUE
from curlshot.vision.spin.align import Complex, align
from curlshot.vision.spin.inclined import rise_of_handle

Array = NDArray[np.float64]
SLANTS = np.column_stack([0.1 + 0 * TIMES, 0.85 - 0.08 * TIMES])
SD = np.full(len(TIMES), 0.005)


def told(shown: Complex, slants: Array = SLANTS) -> complex | None:
    return rise_of_handle(TIMES, shown, align(shown, TRUE, RADII, SD).angle, RADII, slants, SD)


def spoilt(shown: Complex) -> Complex:
    """Pictures that show more of their own, by light or codecs, than of the handle."""
    rng = np.random.default_rng(3)
    own = rng.normal(0, 1, (2, *shown.shape))
    return np.asarray(shown + 2.0 * np.abs(shown).mean() * (own[0] + 1j * own[1]), np.complex64)
