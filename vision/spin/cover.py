"""Rings of a cap's pictures that something lies before: they show much more than they do usually.

A ring shows about as much in all pictures of a cap, however that is turned. A broom or a shoe shows
many times as much beside a handle in the cap's own colour, so that their mean would be a picture
of the broom: angles would follow sweeping.
"""

from __future__ import annotations

import numpy as np

from curlshot.vision.spin.align import Complex

OFTEN = 0.25
"""Quantile of what a ring shows in a stone's pictures that is taken for what it shows uncovered:
sweepers go along with a stone for most of its way, and their brooms to and fro."""

MORE = 2.5
"""From how many times that on a ring is covered, at least in part. Of three sets of clips where
hardly anybody is before a stone .2 to .3 % of the rings are, at twice up to 1.4 %, at 1.5 times up
to 9 %: light comes and goes. At 3.5 brooms before a faint handle seen 50° aslant are left in."""


def uncovered(pictures: Complex) -> Complex:
    """Blank the rings of a stone's pictures that something lies before.

    Parameters
    ----------
    pictures : ndarray, shape (n, orders, rings, channels)
        From `curlshot.vision.spin.handle.cap_spectrum`; a ring that is not seen is 0.

    Returns
    -------
    ndarray, shape (n, orders, rings, channels)
        The same, such rings 0.
    """
    shown = np.sqrt(np.sum(np.abs(pictures[:, 1:-1]) ** 2, axis=(1, 3)))
    usual = [np.quantile(ring[ring > 0], OFTEN) if ring.any() else 0.0 for ring in shown.T]
    clear = shown <= MORE * np.array(usual)
    return np.asarray(pictures * clear[:, None, :, None], np.complex64)
