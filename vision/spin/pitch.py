"""Parallax of handles that rise from the cap: how much of what seems to turn is their height.

A handle stands on the cap at one end, its foot, and its grip is some 4 cm higher. In a slanting
view what is higher is seen farther from the camera: across the line of sight the handle looks
turned, at a slant of 0.3 by a tenth of a radian, along it longer or shorter. The one passes for a
turn of the stone, the other does not, and both go by how steep the handle is: if its height is
h₀ + g·x, what lies at x is shifted by that times the slant. So g is told by how pictures that were
brought onto their mean are longer and shorter than it, and what g turns them by is taken out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import (
    ALIKE,
    LASTING,
    Array,
    Complex,
    ring_weights,
    rings_seen,
    slopes,
    turned,
)
from curlshot.vision.spin.shade import parts, upright_mean

STEEP = 0.2
"""How steep what is seen on caps is, a standard deviation: goose-necks 0.35, paint 0."""

BENT = 0.15
"""How far heights on a cap depart from a plane, in the same measure: by so much the steepness that
makes pictures longer may differ from that which turns them. With 0.1 spins of ten drawn clips whose
handles rise by 0.3 are 0.070 rad/s off, 88 % of them within two errors, with 0.15 0.066 and 91 %;
with 0.2 0.064 and 93 %, but then rises that pictures tell well are left in the angles."""

NEAR = 0.5
"""Slant up to which what is shifted by its height is shifted by little: beyond it grips come to lie
where others were, and how steep they are is told the worse by the square of the slant."""


def levelled(
    pictures: Complex, angles: Array, radii: Array, slants: Array, sd_steep: float = STEEP
) -> tuple[Array, Array]:
    """Take out of the angles of a cap what the steepness of its handle turns pictures by.

    Parameters
    ----------
    pictures : ndarray, shape (n, orders, rings, channels)
        From `curlshot.vision.spin.handle.cap_spectrum`; a ring that is not seen is 0.
    angles : ndarray, shape (n,)
        That bring them onto their mean, rad.
    radii : ndarray, shape (rings,)
        m.
    slants : ndarray, shape (n, 2)
        Of the view (`curlshot.vision.optics.cameras.Cameras.slants`), with the axes that angles
        count from.
    sd_steep : float
        How steep what is seen may be, a standard deviation.

    Returns
    -------
    angle : ndarray, shape (n,)
        rad.
    rise : ndarray, shape (n, 2)
        What is left of it, rad: by how much each angle is off if what is seen is steeper by one
        standard error than was taken out, along either axis of the cap. How steep it is, is one
        number for all pictures, so that these errors go together.
    """
    seen = rings_seen(pictures)
    mean = upright_mean(pictures, angles, seen[:, None, :, None])
    turn, along_x, along_y = slopes(mean, radii, ring_weights(radii))
    own = (slants @ np.array([1, 1j])) * np.exp(-1j * angles)  # as a camera goes about the cap
    own -= own.mean()
    # Of what is times x the outermost harmonics are not known.
    free = np.array([mean[1:-1], turn, along_x, along_y])[:, 1:-1]
    about = np.stack([own.real, own.imag], axis=1).astype(np.float32)
    tilts = np.array([_times_place(along_x, radii), _times_place(along_y, radii)])
    known, pull, turns = 1e-9 * np.eye(2), np.zeros(2), np.zeros((len(angles), 2))
    for part in parts(np.arange(len(angles))):
        steep = (about[part] @ tilts.reshape(2, -1)).reshape(-1, *tilts.shape[1:])
        upright = turned(pictures[part], -angles[part])[:, 2:-2]
        own_known, own_pull, turns[part] = _normal_equations(upright, seen[part], free, steep)
        known, pull = known + own_known, pull + own_pull
    slant = float(np.median(np.hypot(*slants.T)))
    bent = BENT * max((slant / NEAR) ** 2, 1.0)
    apart = np.linalg.inv(known) + bent**2 * np.eye(2)
    share = np.linalg.solve(sd_steep**2 * np.eye(2) + apart, sd_steep**2 * np.eye(2))
    turns -= np.median(turns, axis=0)
    left, axes = np.linalg.eigh(share @ apart)
    rise = turns @ (axes * np.sqrt(left)) @ axes.T
    return angles - turns @ share @ np.linalg.solve(known, pull), rise


def of_axes(rise: Array, turn: float) -> Array:
    """Give what `levelled` leaves by axes that are turned by so much, rad, on the cap."""
    cos, sin = np.cos(turn), np.sin(turn)
    return np.asarray(rise @ np.array([[cos, -sin], [sin, cos]]))


def _normal_equations(
    here: Complex, seen: NDArray[np.bool_], free: Complex, steep: Complex
) -> tuple[Array, Array, Array]:
    """Tell what pictures say of how steep what they show is, whatever their turn and shift.

    Parameters
    ----------
    here : ndarray, shape (n, harmonics, rings, channels)
        Upright.
    seen : ndarray of bool, shape (n, rings)
    free : ndarray, shape (4, harmonics, rings, channels)
        Their mean, and how it changes as it turns and as it is shifted along x and y.
    steep : ndarray, shape (n, 2, harmonics, rings, channels)
        How each changes with the steepness along x and y.

    Returns
    -------
    known, pull : ndarray, shape (2, 2) and (2,)
        Matrix and right-hand side of the equations of the steepness.
    turns : ndarray, shape (n, 2)
        By what angle a steepness of 1 turns each picture, rad.
    """
    shown = seen[:, None, None, :, None]
    columns = _real(free, shown)
    rows = _real(np.concatenate([here[:, None], steep], axis=1), shown)
    normal = columns @ columns.transpose(0, 2, 1)
    normal += (1e-9 * np.trace(normal, axis1=1, axis2=2)[:, None, None] + 1e-12) * np.eye(4)
    share = np.linalg.solve(normal, columns @ rows.transpose(0, 2, 1)).transpose(0, 2, 1)
    rest = rows - share.astype(rows.dtype) @ columns
    noise = ALIKE**2 * (rest[:, 0] ** 2).sum(1) / np.maximum(seen.mean(1) * rows.shape[2], 1)
    # No picture counts for more than the median one; a dim one changes by as much less.
    worth = 1 / (LASTING**2 * np.maximum(noise, np.median(noise)) + 1e-12)
    bright = np.maximum(share[:, 0, 0], 0.2)[:, None, None]
    tilted = (bright * worth[:, None, None] * rest[:, 1:]).swapaxes(0, 1).reshape(2, -1)
    plain = (bright * rest[:, 1:]).swapaxes(0, 1).reshape(2, -1)
    return tilted @ plain.T, tilted @ rest[:, 0].ravel(), np.asarray(share[:, 1:, 1])


def _times_place(picture: Complex, radii: Array) -> Complex:
    """Harmonics of a picture times x and times y, m: (2, …), one fewer of them at either end."""
    low, high, half = picture[:-2], picture[2:], 0.5 * radii[:, None]
    return np.asarray([half * (low + high), -1j * half * (low - high)], np.complex64)


def _real(values: Complex, shown: NDArray[np.bool_]) -> Array:
    """Real and imaginary parts of what is shown, (n, p, …), side by side: (n, p, a)."""
    seen = values * shown
    flat = seen.reshape(*seen.shape[:2], -1)
    return np.concatenate([flat.real, flat.imag], axis=2)
