"""Light and shade that stay while a cap turns, estimated from its pictures and taken out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import ORDERS, TOGETHER, Array, Complex, turned

SPREAD = 1.0
"""Standard deviation of a harmonic's phase, rad, that holds its light near 0 as much as pictures of
full turns tell it: of these half is taken out, the most. A handle that is shaded on one side, or
shifted by its height in a slanting view, has a part that hardly turns: where all of that is taken
out, angles stay behind (spins of 73 clips of four renderers and of cut-out stones by a tenth more,
in the median, than where half is)."""


def parts(index: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Cut a list of pictures: what is worked out for all of them at once takes memory."""
    return [index[begin : begin + TOGETHER] for begin in range(0, len(index), TOGETHER)]


def upright_mean(pictures: Complex, angles: Array, shown: NDArray[np.bool_]) -> Complex:
    """Mean of the pictures whose angles are known, turned back by these, ring by ring."""
    known = np.flatnonzero(np.isfinite(angles))
    total = np.zeros(pictures.shape[1:], np.complex64)
    for part in parts(known):
        total += turned(pictures[part], -angles[part]).sum(0)
    return np.asarray(total / np.maximum(shown[known].sum(0), 1), np.complex64)


def unturned(pictures: Complex, angles: Array, shown: NDArray[np.bool_]) -> Complex:
    """Part of the pictures of a turning cap that does not turn with it: light and shadow.

    Least squares on each harmonic, F(t) = S + R exp(−i k θ(t)), S held near 0 as far as the
    harmonic turns too little to tell the two apart.

    Parameters
    ----------
    pictures : ndarray, shape (n, orders, rings, channels)
    angles : ndarray, shape (n,)
        How they are turned, rad.
    shown : ndarray of bool, shape (n, 1, rings, 1)
        Which rings are seen; the others are 0.

    Returns
    -------
    ndarray, shape (orders, rings, channels)
    """
    phase = np.exp(-1j * ORDERS * angles[:, None])
    often = np.maximum(shown.sum(0), 1)
    along = np.einsum("nk,nr->kr", phase, shown[:, 0, :, 0])[..., None] / often
    back = upright_mean(pictures, angles, shown)
    share = 1 - np.abs(along) ** 2
    light = (pictures.sum(0) / often - along * back) / (share + SPREAD**2)
    return np.asarray(light, np.complex64)
