"""Registration of the pictures of one cap: turned and shifted onto their mean.

What stands above the cap moves over it as the camera sees it from elsewhere, and a centre has
its error. A bar that is seen on one side of the centre only looks turned where it is shifted,
so the shift is found with the angle (Gauss and Newton's method on the angular harmonics).

A picture f shifted by d is f − d·∇f, and with F_k(r) the harmonic k on the ring r
(∂x ± i ∂y) f has the harmonic k ± 1 of F_k' ∓ k F_k / r.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex64]

ORDERS = np.arange(1, 18)
"""Harmonics that are kept of a picture: one more at each end, for its gradient."""

HARMONICS = ORDERS[1:-1]
"""Those that are compared."""

_ROUNDS, _ENOUGH = 6, 0.001
"""How often angles and shifts are found anew against the mean that they give, at most, and by how
little angles change where they are found, rad: a tenth of what the best of them err by."""

TOGETHER = 128
"""Pictures that are brought nearer to their mean at a time: more take memory, and no less time."""

ALIKE = 2.5
"""How much larger errors are than if every ring, harmonic and colour erred for itself."""


LASTING = 3.5
"""How much larger errors are than one picture tells: what stands up looks otherwise from each
side, and light and blur change slowly. Handles of two renderers and of cut-out stones err so."""


@dataclass(frozen=True)
class Alignment:
    """Angles (n,), rad, their standard errors, and shifts (n, 2) in the frame of the cap, m."""

    angle: Array
    sd: Array
    shift: Array


def turned(spectra: Complex, angles: Array) -> Complex:
    """Spectra (n, orders, rings, channels) of the caps turned counter-clockwise by `angles`."""
    phase = np.exp(-1j * ORDERS * angles[:, None]).astype(np.complex64)
    rows = spectra.reshape(len(spectra), len(ORDERS), -1)  # long ones are three times as fast
    return np.asarray(rows * phase[:, :, None], np.complex64).reshape(spectra.shape)


def ring_weights(radii: Array) -> Array:
    """Weights of rings, shape (rings,): their squares go as the rings' lengths."""
    return np.asarray(np.sqrt(radii / radii[-1]))


def rings_seen(spectra: Complex) -> NDArray[np.bool_]:
    """Which rings of the pictures (n, orders, rings, channels) are seen, shape (n, rings)."""
    # By real and imaginary parts, and one axis after the other: ten times as fast as at once.
    return np.asarray((spectra.view(np.float32) != 0).any(1).any(-1))


def align(spectra: Complex, angles: Array, radii: Array, sd_shift: Array) -> Alignment:
    """Turn and shift pictures of a cap onto their mean.

    Parameters
    ----------
    spectra : ndarray, shape (n, orders, rings, channels)
        From `curlshot.vision.spin.handle.cap_spectrum`; a ring that is not seen is 0.
    angles : ndarray, shape (n,)
        Where to begin, rad; within a few tenths of the truth.
    radii : ndarray, shape (rings,)
        m.
    sd_shift : ndarray, shape (n,)
        Standard deviations of the shifts, m, per axis.
    """
    seen = rings_seen(spectra)
    weight = ring_weights(radii)
    often = np.maximum(seen.sum(0), 1)[:, None].astype(np.float32)
    angle, shift = angles.astype(float), np.zeros((len(angles), 2))
    sd = np.full(len(angles), np.nan)
    parts = [slice(begin, begin + TOGETHER) for begin in range(0, len(angles), TOGETHER)]
    for _ in range(_ROUNDS):
        sums = [turned(spectra[k], -angle[k]).sum(0) for k in parts]
        mean = np.asarray(np.sum(sums, axis=0) / often, np.complex64)
        ways = slopes(mean, radii, weight)
        most = 0.0
        for k in parts:
            upright = turned(spectra[k], -angle[k])[:, 1:-1]
            step, sd[k] = _step(upright, seen[k], shift[k], sd_shift[k], mean[1:-1], ways)
            angle[k] += np.clip(step[:, 0], -0.1, 0.1)
            shift[k] += step[:, 1:]
            most = max(most, float(np.abs(step[:, 0]).max()))
        if most < _ENOUGH:
            break
    return Alignment(angle, sd, shift)


def _step(
    here: Complex,
    seen: NDArray[np.bool_],
    shift: Array,
    sd_shift: Array,
    mean: Complex,
    ways: Complex,
) -> tuple[Array, Array]:
    """Tell by how much farther upright pictures are turned and shifted, (n, 3), and the sd."""
    flat = ways.reshape(3, -1)
    moved = np.concatenate([np.zeros((len(shift), 1)), shift], axis=1)
    model = mean + (moved.astype(np.float32) @ flat).reshape(-1, *ways.shape[1:])
    model *= seen[:, None, :, None]
    gain = product(here, model) / np.maximum(product(model, model), 1e-12)
    rest = here * (1 / np.maximum(gain, 0.1)).astype(np.float32)[:, None, None, None] - model
    count = 2 * rest[0, :, 0].size * np.maximum(seen.sum(1), 1)
    noise = ALIKE**2 * product(rest, rest) / count
    by_ring = np.einsum("pkrc,qkrc->rpq", ways.conj(), ways).real
    normal = np.einsum("nr,rpq->npq", seen.astype(float), by_ring)
    prior = np.diag([0.0, 1.0, 1.0]) * (noise / sd_shift**2)[:, None, None]
    normal += prior + 1e-12 * np.eye(3)
    pull = (rest.reshape(len(rest), -1) @ flat.conj().T).real
    pull -= np.einsum("npq,nq->np", prior, moved)
    inverse = np.linalg.inv(normal)
    return np.einsum("npq,nq->np", inverse, pull), np.sqrt(inverse[:, 0, 0] * noise)


def product(first: Complex, second: Complex) -> Array:
    """Real part of the scalar product of each of n pictures with another."""
    flat, other = first.reshape(len(first), 1, -1), second.conj().reshape(len(second), -1, 1)
    return np.asarray((flat @ other).real[:, 0, 0])


def slopes(mean: Complex, radii: Array, weight: Array) -> Complex:
    """Change of a picture's compared harmonics with angle and shift: (3, harmonics, rings, …)."""
    plain = mean / weight[:, None]
    outwards = np.gradient(plain, radii, axis=1)
    around = ORDERS[:, None, None] / radii[:, None] * plain
    raised, lowered = (outwards - around)[:-2], (outwards + around)[2:]
    ways = [
        -1j * HARMONICS[:, None, None] * plain[1:-1],
        -0.5 * (raised + lowered),
        0.5j * (raised - lowered),
    ]
    return np.asarray(np.array(ways) * weight[:, None], np.complex64)
