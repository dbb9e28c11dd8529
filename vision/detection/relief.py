"""What a cap shows around its centre: on a stone a handle, on a disc of paint nothing.

A handle is seen as contrast: of colour, or of shades where it is of the cap's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import nan, sqrt

import numpy as np
from numpy.typing import NDArray

from curlshot.data.sheet import STONE
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.patch import handle_radii
from curlshot.vision.spin.align import ORDERS, ring_weights

Complex = NDArray[np.complex64]
Flags = NDArray[np.bool_]

COARSE = (ORDERS >= 2) & (ORDERS <= 5)
"""Angular harmonics that a bar has most of. Of more there is but noise of films; a lamp on one side
has the first."""

WITHIN = 0.7
"""Share of the cap's radius up to which contrast is that of a handle: nearer to the rim it is that
of an edge which is found a bit aside."""

_RADII = handle_radii(STONE)
_INNER = int(np.searchsorted(_RADII, WITHIN * STONE.cap_radius))
_RINGS = slice(len(_RADII), len(_RADII) + _INNER)
"""Those that are unrolled at the height of the cap, the second half of all."""
_WEIGHT = float((ring_weights(_RADII)[:_INNER] ** 2).sum())

BARE = 4.0
"""Contrast, L*a*b* units, below which there may be no handle. In 40 clips 63 discs of paint and
icons have 0.5 to 4.4 (the median is 1.1; those with rings within them have most), 239 stones 2.6
to 45; some 560 stones in 127 real pictures 2.8 and more."""

BARE_ALONE, FINE = 2.2, 0.0125
"""Contrast of one picture with itself, L*a*b* units, below which there is no handle beside stones
that show theirs, where pixels are so fine, m: 561 stones in 127 real pictures have 2.8 and more,
squares of a house that is painted as a tartan 0.9 to 1.8."""


def contrast(here: Complex, there: Complex) -> float:
    """Contrast around the centre that two pictures of a stone's cap share, L*a*b* units.

    Noise of each picture adds to it only if they are the same one.

    Parameters
    ----------
    here, there : ndarray, shape (orders, rings, channels)
        From `curlshot.vision.spin.handle.cap_spectrum`, of a stone that hardly turned between them.

    Returns
    -------
    float
        Root mean square, negative where they are rather opposites.
    """
    power = 2 * float(_shared(here, there).sum().real) / _WEIGHT
    return sqrt(power) if power > 0 else -sqrt(-power)


def contrast_turned(here: Complex, there: Complex) -> float:
    """Give the same of pictures between which a stone may have turned, be it by half a turn.

    Half as much of the noise of each picture adds to it as if they were the same one.
    """
    return sqrt(2 * float(np.abs(_shared(here, there)).sum()) / _WEIGHT)


def without_handle(seen: Sequence[Detection]) -> Flags:
    """Tell which of several things have no handle, by one picture of each, shape (n,).

    None has where no handle is seen at all: that is how stones here look.
    """
    shown = np.array([own_contrast(one) if one.pixel_size <= FINE else nan for one in seen])
    return np.asarray((shown < BARE_ALONE) & (shown >= BARE).any())


def own_contrast(seen: Detection) -> float:
    """Contrast of the picture of a detection with itself; NaN where its cap is not seen well."""
    if seen.spectrum is None:
        return nan
    spectrum = seen.spectrum.get()
    return contrast(spectrum, spectrum)


def _shared(here: Complex, there: Complex) -> Complex:
    """Products of two pictures, summed for each of the coarse harmonics, shape (4,)."""
    first, second = (one[COARSE][:, _RINGS] for one in (here, there))
    return np.asarray((first.conj() * second).sum((1, 2)))
