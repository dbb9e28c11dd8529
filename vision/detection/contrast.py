"""By what a cap differs from the granite around it: by its hue, and by its lightness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Flags = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

LIGHT = 0.1
"""What lightness has to say beside hue: bolts and highlights are light and dark alike; the hue is
what ends at the cap's edge."""

MOST_LIGHT = 0.03
"""Most that lightness has of the say of a vivid hue: lamps from one side draw the edge of a cap
that is much lighter than its granite aside, and that of a dark one to the other side."""

FAINT, VIVID = 40.0, 60.0
"""Difference of hue (L*a*b* units) up to which lightness is needed, and from which it is not: pale
and dark caps have 30 to 45, red and yellow ones 70 to 90, and in a grey picture none has any."""

OWN_SPREAD, OWN_APART = np.array([15.0, 7.0, 7.0], np.float32), 0.8
"""Usual standard deviation of L*, a* and b* within a cap or its granite, and by how many of these
the two differ at least."""

CLEAR, FAR_OFF = 1.5, 4.5
"""Standard deviations by which a colour is nearer to that of a cap than to that of granite if it is
the one and not the other, and from which on it is neither."""

ALIKE = 25.0, 14.0
"""By how much the lightness and the hue of granite differ from stone to stone, L*a*b* units."""


def mean_colours(values: Floats, use: Floats) -> Array:
    """Mean colours (n, 3) of samples (n, rays, radii, 3) by weights; 0 where there are none."""
    total = use.reshape(len(use), 1, -1) @ values.reshape(len(values), -1, 3)
    return np.asarray(total[:, 0] / np.maximum(use.sum((1, 2)), 1)[:, None], float)


def by_hue(cap: Array, granite: Array) -> Array:
    """Weights of L*a*b* by which caps are 1 more than their granite, mostly by hue.

    Parameters
    ----------
    cap, granite : ndarray, shape (n, 3)
        Their colours.

    Returns
    -------
    ndarray, shape (n, 3)
    """
    apart = cap - granite
    hue = np.hypot(apart[:, 1], apart[:, 2])
    most = MOST_LIGHT * hue**2 / np.maximum(apart[:, 0] ** 2, 1.0)
    vivid = np.interp(hue, [FAINT, VIVID], [0.0, 1.0])
    light = LIGHT - vivid * np.maximum(LIGHT - most, 0.0)
    along = apart.copy()
    along[:, 0] *= light
    return np.asarray(along / np.maximum((apart * along).sum(1), 1.0)[:, None])


def by_lightness(cap: Array, granite: Array) -> Array:
    """Weight of the lightness by which caps are 1 more than their granite, shape (n,)."""
    apart = (cap - granite)[:, 0]
    return np.asarray(1 / np.where(np.abs(apart) < 1, 1.0, apart))


def worth_of(to_cap: Floats, to_granite: Floats, clear: Floats | float = CLEAR) -> Floats:
    """Say what colours may be that are so many standard deviations off those of cap and granite.

    Parameters
    ----------
    to_cap, to_granite : ndarray of one shape
    clear : ndarray or float
        By how much the nearer one must be nearer to be what it is without doubt.

    Returns
    -------
    ndarray
        1 cap, −1 granite, 0 neither; what may be either is neither.
    """
    nearer = np.clip((to_granite - to_cap) / clear, -1, 1)
    likely = np.clip((FAR_OFF - np.minimum(to_cap, to_granite)) / CLEAR, 0, 1)
    return np.asarray(nearer * likely, np.float32)


def own_worth(lab: Bytes, cap: slice, ring: slice, granite: Array | None = None) -> Floats:
    """Say what samples may be by the colours of cap and granite in their own place.

    Parameters
    ----------
    lab : ndarray, shape (n, rays, radii, 3)
    cap, ring : slice
        Radii at which the one and the other is seen.
    granite : ndarray, shape (3,), optional
        The colour of granite, where it is known.

    Returns
    -------
    ndarray, shape (n, rays, radii)
        1 cap, −1 granite, 0 neither; 0 where the two do not differ, or what is around the cap
        is no such granite.
    """
    scaled = lab / OWN_SPREAD
    middles = [np.median(scaled[:, :, part].reshape(len(lab), -1, 3), 1) for part in (cap, ring)]
    to_cap, to_granite = (
        np.sqrt(((scaled - middle[:, None, None].astype(np.float32)) ** 2) @ np.ones(3, np.float32))
        for middle in middles
    )
    apart = np.sqrt(((middles[0] - middles[1]) ** 2).sum(1))
    told = apart > OWN_APART
    if granite is not None:
        told &= alike(middles[1] * OWN_SPREAD, granite)
    clear = np.minimum(CLEAR, 0.6 * np.maximum(apart, OWN_APART)).astype(np.float32)
    worth = worth_of(to_cap, to_granite, clear[:, None, None])
    return np.asarray(worth * told[:, None, None], np.float32)


def alike(granite: Array, known: Array) -> Flags:
    """Whether colours, shape (..., 3), may be of granite of which other stones are."""
    off = granite - known
    return np.asarray(
        (np.abs(off[..., 0]) < ALIKE[0]) & (np.hypot(off[..., 1], off[..., 2]) < ALIKE[1])
    )
