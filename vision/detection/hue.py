"""Hue along rays as it was before it was coded.

A coded picture has its hue at half of its size or coarser, and on what the codec leaves of it: the
narrow ring of granite between a cap and vivid paint looks half as vivid as these two.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.detection.rays import Rays
from curlshot.vision.video.colour import lab_of
from curlshot.vision.video.picture import TO_CHROMA

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

BLUR = 2.5
"""Standard deviation of the blur of hue, px: at 2 and at 3 the granite of real stones on red paint,
coded by H.264 as usual, is told less well."""

NOISE = 0.025
"""Power of what is not hue, a share of that of hue: less sharpens more, and noise too."""

STEPS = 20
"""Scales of a picture that are told apart, per e-fold."""


def sharpened(rays: Rays, scale: Array) -> Rays:
    """Sharpen the hue along rays by a Wiener filter; lightness stays.

    Parameters
    ----------
    rays : Rays
        About n places.
    scale : ndarray, shape (n,)
        Of the picture there, px/m.
    """
    bgr = rays.bgr.astype(np.float32)
    luma = (bgr @ TO_CHROMA[0].astype(np.float32))[..., None]
    radii = len(rays.radius)
    step = float(rays.radius[1] - rays.radius[0])
    blur = np.exp(np.rint(STEPS * np.log(BLUR / scale / step)) / STEPS).tolist()
    filters = np.array([_wiener(one, radii) for one in blur]).reshape(-1, 1, radii, radii)
    sharp = np.clip(np.rint(luma + filters @ (bgr - luma)), 0, 255).astype(np.uint8)
    return replace(rays, bgr=sharp, lab=lab_of(sharp.reshape(1, -1, 3)).reshape(sharp.shape))


@lru_cache(maxsize=64)
def _wiener(blur: float, count: int) -> Floats:
    """Matrix that undoes a Gaussian blur of `count` samples; beyond them the ends go on."""
    length = 3 * count
    passed = np.exp(-2 * (np.pi * np.fft.rfftfreq(length) * blur) ** 2)
    gain = passed * (1 + NOISE) / (passed**2 + NOISE)
    ends = np.clip(np.arange(length) - count, 0, count - 1)
    each = np.fft.irfft(np.fft.rfft(np.eye(count)[ends], axis=0) * gain[:, None], length, axis=0)
    return np.asarray(each[count : 2 * count], np.float32)
