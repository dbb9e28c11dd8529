"""Mirrored lamps: what of a cap's pictures turns with it, and what is light that changes slowly.

A lamp mirrored on a domed cap stays on the side of the lamp while the cap turns, and wanders
over it as the stone goes on. Where that is brighter than the handle, pictures brought onto their
mean are brought onto the light, and the angle stands still. So a cap's picture is taken for a
sum of two: one that turns, R exp(−i k θ(t)) in its harmonic k, and one that changes slowly, along
straight lines between knots of time. For given angles both are told by least squares; and over
a second or so, in which a spin is constant, the spin is that which is the more probable than the
spin the other way round: noise and light turn neither way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import HARMONICS, ORDERS, Array, Complex, rings_seen

KNOT = 0.4
"""Time between the knots of the light, s."""

FAINT = 0.05
"""How little of a harmonic may be left beside the light for its turning part to be told by half."""

SPAN, STEP, FEWEST = 0.9, 0.25, 8
"""Length of the stretches over which a spin is told and how far apart they are, s; pictures."""

SPINS = np.linspace(-5.0, 5.0, 101)
"""Spins that are tried, rad/s."""

TICKS = 6
"""Digits of a second to which times within a stretch are told: a micro is 10⁻⁴ rad at most."""

CHANGE, SUDDEN = 0.1, 2.0
"""What a change of the spin from a stretch to the next costs per rad/s, in logarithms of what is
left of a harmonic, and from which on a larger one costs no more: hits change spins."""

NOTHING = 0.05
"""By how much, in such logarithms, a spin must be the more probable for a cap to be seen to turn in
a stretch."""

SIDES = 512
"""Columns that are solved for at once: more take memory, and little less time each."""

OFTEN = 0.9
"""Share of the pictures that must show a ring for it to be used."""


@dataclass(frozen=True)
class Unlit:
    """Pictures without the light on them.

    Attributes
    ----------
    cap : ndarray, shape (orders, rings, channels)
        What turns.
    pictures : ndarray, shape (n, orders, rings, channels)
        As they would be without the light.
    share : float
        How much of what no light explains turns, 0 to 1.
    told : ndarray, shape (n,)
        How much of what turns is unlike any light, by picture, 0 to 1.
    """

    cap: Complex
    pictures: Complex
    share: float
    told: Array


def unlit(times: Array, pictures: Complex, angles: Array) -> Unlit:
    """Tell what turns in pictures of a cap from the light on it, if its angles are known.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    pictures : ndarray, shape (n, orders, rings, channels)
        Of the orders `curlshot.vision.spin.align.ORDERS`.
    angles : ndarray, shape (n,)
        rad.
    """
    flat = pictures.reshape(len(times), len(ORDERS), -1)
    knots = _between_knots(times)
    held = knots.T @ knots + 1e-6 * np.eye(knots.shape[1])
    phase = np.exp(-1j * ORDERS * angles[:, None])
    sides = phase.view(np.float64)  # real matrices need not be made complex, twice as large
    own = (sides - knots @ np.linalg.solve(held, knots.T @ sides)).view(np.complex128)
    pulled = _times(knots.T, flat)
    dark = flat - _times(knots, _solved(held, pulled))
    left = np.sum(np.abs(own) ** 2, axis=0) + FAINT * len(times)
    pull = np.einsum("nk,nkx->kx", own.conj().astype(np.complex64), dark)
    cap = np.asarray(pull / left[:, None], np.complex64)
    size = np.sum(np.abs(cap[1:-1]) ** 2, axis=1)
    explained = np.sum(np.abs(pull[1:-1]) ** 2, axis=1) / left[1:-1]
    most = np.sum(np.abs(dark[:, 1:-1]) ** 2)
    dark += (phase - own).astype(np.complex64)[:, :, None] * cap  # what turns as slowly as light
    return Unlit(
        cap.reshape(pictures.shape[1:]),
        dark.reshape(pictures.shape),
        float(explained.sum() / max(most, 1e-12)),
        np.abs(own[:, 1:-1]) ** 2 @ size / max(float(size.sum()), 1e-12),
    )


def _between_knots(times: Array) -> Array:
    """Weights of the values at knots in the values at times, (n, knots), along straight lines."""
    count = max(round(float(times[-1] - times[0]) / KNOT), 1) + 1
    place = (count - 1) * (times - times[0]) / (times[-1] - times[0])
    before = np.minimum(place.astype(np.intp), count - 2)
    rows, weights = np.arange(len(times)), np.zeros((len(times), count))
    weights[rows, before], weights[rows, before + 1] = before + 1 - place, place - before
    return weights


def _solved(matrix: Array, values: Complex) -> Complex:
    """Solve for values (n, …) with a real matrix (n, n): in parts, which take less memory."""
    sides = values.reshape(len(values), -1).view(np.float32)
    found = np.empty_like(sides)
    for begin in range(0, sides.shape[1], SIDES):
        part = slice(begin, begin + SIDES)
        found[:, part] = np.linalg.solve(matrix, sides[:, part])
    return found.view(np.complex64).reshape(values.shape)


def _times(matrix: Array, values: Complex) -> Complex:
    """Product of a matrix (m, n) and values (n, orders, …), both in single precision."""
    parts = np.ascontiguousarray(values, np.complex64).reshape(len(values), -1).view(np.float32)
    product = matrix.astype(np.float32) @ parts
    return np.asarray(product.view(np.complex64).reshape(-1, *values.shape[1:]))


def course(times: Array, pictures: Complex) -> tuple[Array, float]:
    """Angles of a cap by its spins from stretch to stretch, whatever light is on it.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    pictures : ndarray, shape (n, orders, rings, channels)
        Of the orders `curlshot.vision.spin.align.ORDERS`.

    Returns
    -------
    angles : ndarray, shape (n,)
        rad, 0 at first. A stretch in which nothing is seen to turn has no spin.
    share : float
        How much of what no light explains turns by them: see `Unlit`.
    """
    often = rings_seen(pictures).mean(0) > OFTEN
    seen = pictures[:, 1:-1, often].reshape(len(times), len(HARMONICS), -1)
    each = list(_stretches(times, seen))
    if not each:
        return np.zeros(len(times)), 0.0
    middles, odds = (np.array(column) for column in zip(*each, strict=True))
    spin = np.interp(times, middles, _likely(odds))
    steps = 0.5 * (spin[1:] + spin[:-1]) * np.diff(times)
    angles = np.concatenate([[0.0], np.cumsum(steps)])
    return angles, unlit(times, pictures, angles).share


def _stretches(times: Array, seen: Complex) -> Iterator[tuple[float, Array]]:
    """Middles of stretches, and how much more probable each spin is there than its opposite.

    By the logarithm of what either leaves of what changes in a harmonic, in the mean over these.
    """
    for middle in np.arange(times[0] + SPAN / 2, times[-1] - SPAN / 2 + 1e-6, STEP):
        inside = np.abs(times - middle) <= SPAN / 2 + 1e-6
        if inside.sum() < FEWEST:
            yield float(middle), np.zeros(len(SPINS))
            continue
        tau = times[inside] - middle
        # Where frames follow each other evenly, these are the same again and again.
        line, phase, left = _tried(np.round(tau, TICKS).tobytes())
        part = np.moveaxis(seen[inside], 1, 0)
        part = part - line @ (line.T @ part)
        pull = np.sum(np.abs(phase @ part) ** 2, axis=2) / left
        most = np.maximum(np.sum(np.abs(part) ** 2, axis=(1, 2)), 1e-12)
        rest = np.log(1 - pull / most[:, None]).mean(0)  # more than 0 is left: see `FAINT`
        yield float(middle), rest[::-1] - rest


@lru_cache(maxsize=32)
def _tried(tau: bytes) -> tuple[NDArray[np.float32], Complex, Array]:
    """Tell what all spins turn in pictures at times from the middle of a stretch, s.

    Returns
    -------
    line : ndarray, shape (n, 2)
        Orthonormal columns that light follows: what stays and what changes evenly.
    phase : ndarray, shape (harmonics, spins, n)
        Turns the harmonics back by each spin, without what such a light explains.
    left : ndarray, shape (harmonics, spins)
        How much of each turning harmonic light leaves.
    """
    times = np.frombuffer(tau)
    line = np.linalg.qr(np.stack([np.ones_like(times), times], axis=1))[0].astype(np.float32)
    turn = np.exp(-1j * np.outer(times, SPINS))
    turns = accumulate([turn ** HARMONICS[0], *[turn] * (len(HARMONICS) - 1)], np.multiply)
    phase = np.array([*turns], np.complex64)
    phase -= line @ (line.T @ phase)
    left = np.sum(np.abs(phase) ** 2, axis=1) + FAINT * len(times)
    return line, np.ascontiguousarray(phase.conj().transpose(0, 2, 1)), left


def _likely(odds: Array) -> Array:
    """Spins from stretch to stretch, (n,), that are the most probable and change little."""
    apart = np.minimum(np.abs(SPINS[:, None] - SPINS), SUDDEN)
    best, links = odds[0], []
    for more in odds[1:]:
        ways = best[:, None] - CHANGE * apart
        links.append(ways.argmax(0))
        best = ways.max(0) + more
    at = [int(best.argmax())]
    for link in reversed(links):
        at.append(int(link[at[-1]]))
    chosen = np.array(at[::-1])
    told = odds[np.arange(len(odds)), chosen]
    return np.where(told > NOTHING, SPINS[chosen], 0.0)
