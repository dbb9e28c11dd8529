"""What tests of align share."""

from __future__ import annotations

import numpy as np

from curlshot.tests.helpers.vision.handles import RADII, patch
from curlshot.vision.spin.align import Complex
from curlshot.vision.spin.handle import cap_spectrum


def spectra(angles: list[float], shifts: list[tuple[float, float]]) -> Complex:
    pairs = zip(angles, shifts, strict=True)
    return np.array([cap_spectrum(patch(angle, None, shift), RADII) for angle, shift in pairs])
