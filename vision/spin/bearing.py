"""Which way a handle points: the bar that stands out of a cap's mean picture."""

from __future__ import annotations

from math import pi

import numpy as np

from curlshot.vision.spin.align import ORDERS, Complex

DIRECTIONS = 96
"""Directions in which a cap's picture is looked at: enough for the highest of its harmonics."""

BAR = 0.35
"""How much of what stands out lies along one axis, on both sides, 0 to 1, where a handle is seen.
Nine handles of films in which it is that much lay within 0.1 rad of their own, one at the picture's
edge 0.2; with 0.2 three were 0.2 to 0.3 off. Drawn ones have 0.7 to 0.9, mirrored lamps and noise
0.3 at most, but caps of which half is covered 0.6."""


def bearing(mean: Complex) -> float | None:
    """Direction of a cap's handle, from its picture.

    What differs most from the median of its ring on both sides of the centre, darker, brighter or
    of another hue, is taken for the handle. Its two ends are much alike: the direction is that of
    the one that stands out more, and may be half a turn off.

    Parameters
    ----------
    mean : ndarray, shape (orders, rings, channels)
        Harmonics of the cap's picture (`curlshot.vision.spin.handle.cap_spectrum`).

    Returns
    -------
    float or None
        Rad, counter-clockwise from the axis at which the picture was unrolled, within pi either
        way; None where no bar stands out.
    """
    direction = np.linspace(0, 2 * pi, DIRECTIONS, endpoint=False)
    # A centre that is slightly off and light from one side look like the first harmonic.
    waves = np.exp(1j * direction[:, None] * ORDERS[1:])
    seen = np.tensordot(waves, mean[1:], axes=1).real
    aside = ((seen - np.median(seen, axis=0)) ** 2).sum((1, 2))
    total = aside.sum()
    if not total > 0:
        return None
    # A lamp or a shade stands out to one side, a handle to both.
    both = np.sqrt(aside * np.roll(aside, DIRECTIONS // 2))
    bar = both @ np.exp(2j * direction) / total
    if abs(bar) < BAR:
        return None
    axis = float(np.angle(bar)) / 2
    end = float(aside @ np.cos(direction - axis))
    return axis if end >= 0 else axis - pi * float(np.sign(axis) or 1.0)
