"""Rotation of one picture of a cap against another, by circular cross-correlation.

Both are angular harmonics on rings (`curlshot.vision.spin.handle.cap_spectrum`): the angle that
brings them together is the maximum of their circular cross-correlation.
"""

from __future__ import annotations

from functools import lru_cache
from math import ceil, nan, sqrt

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import HARMONICS, Array, Complex, rings_seen

_GRID = 1440
"""Angles of a whole turn that are tried."""

_TURN = 1j * HARMONICS
"""Logarithms by which a radian turns the harmonics."""


@lru_cache(maxsize=64)
def _offsets(reach: float) -> tuple[Array, NDArray[np.complex128]]:
    """Angles up to `reach` either way, rad, and how they turn the harmonics."""
    offset = np.linspace(-reach, reach, max(int(_GRID * reach / np.pi), 9))
    return offset, np.exp(_TURN[:, None] * offset)


def crossed(reference: Complex, spectra: Complex) -> tuple[Complex, Array]:
    """Products of a reference and pictures (n, harmonics), and the most that they come to (n,)."""
    count, harmonics = len(spectra), len(HARMONICS)
    model, seen = reference[1:-1], spectra[:, 1:-1]
    shown = rings_seen(seen) @ (np.abs(model) ** 2).sum((0, 2))
    rows, parts = seen.reshape(count, harmonics, 1, -1), seen.reshape(count, 1, -1)
    size = (parts @ parts.conj().swapaxes(1, 2))[:, 0, 0].real
    cross = rows @ model.conj().reshape(harmonics, -1, 1)
    return cross[..., 0, 0], np.sqrt(shown * size)


def _nearest(cross: Complex, expected: Array, reach: float) -> tuple[Array, Array]:
    """Angles about those expected at which pictures are most alike, to 2 mrad, and how much."""
    offset, phases = _offsets(ceil(100 * reach) / 100)
    value = ((cross * np.exp(_TURN * expected[:, None])) @ phases).real
    best = value.argmax(1)
    return expected + offset[best], value[np.arange(len(best)), best]


def angle_between(
    reference: Complex,
    spectrum: Complex,
    expected: float,
    reach: float,
    shown: NDArray[np.bool_] | None = None,
) -> tuple[float, float]:
    """Angle by which one cap is turned against a reference: `angles_between` of one, to 2 mrad.

    Each frame asks for one a stone and more: so written it takes half of the time of those. Whoever
    has many pictures may say which rings are `shown` by the harmonics that are compared.
    """
    model, seen = reference[1:-1], spectrum[1:-1]
    if shown is None:
        shown = rings_seen(seen[None])[0]
    if not shown.all():
        model = np.where(shown[:, None], model, np.complex64(0))
    energy = sqrt(np.vdot(model, model).real * np.vdot(seen, seen).real)
    if not energy:
        return nan, 0.0
    cross = (seen * model.conj()).reshape(len(HARMONICS), -1).sum(1)
    offset, phases = _offsets(ceil(100 * reach) / 100)
    value = ((cross * np.exp(_TURN * expected)) @ phases).real
    best = int(value.argmax())
    return expected + float(offset[best]), float(value[best]) / energy


def angles_between(
    reference: Complex, spectra: Complex, expected: Array, reach: float
) -> tuple[Array, Array]:
    """Angles by which caps are turned against a reference, if they are not shifted.

    Parameters
    ----------
    reference : ndarray, shape (orders, rings, channels)
    spectra : ndarray, shape (n, orders, rings, channels)
    expected : ndarray, shape (n,)
        About where the angles are sought, rad.
    reach : float
        How far from there, rad.

    Returns
    -------
    angle, likeness : ndarray, shape (n,)
        Angles nearest to what was expected, rad; correlations of the two pictures, 0 to 1.
    """
    cross, energy = crossed(reference, spectra)
    blank = energy <= 0
    angle, _ = _nearest(cross, expected, reach)
    for _ in range(4):  # Newton's method on a sum of cosines
        phase = cross * np.exp(_TURN * angle[:, None])
        slope, bend = -phase.imag @ HARMONICS, -phase.real @ HARMONICS**2
        step = -slope / np.where(bend < 0, bend, -np.inf)
        angle = angle + np.clip(step, -0.05, 0.05)
    likeness = (cross * np.exp(_TURN * angle[:, None])).real.sum(1)
    likeness = np.where(blank, 0.0, likeness / np.where(blank, 1.0, energy))
    return np.where(blank, np.nan, angle), np.asarray(likeness, np.float64)
