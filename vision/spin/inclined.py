"""Handles that rise so much that no small shift tells it: unrolled on a plane that rises with them.

A goose-neck's grip is some 5 cm above the foot at its other end. At a slant of 0.8 the one is seen
4 cm beside the other, more than a grip is wide, and what is off no longer goes as the steepness
does (`curlshot.vision.spin.pitch` takes it so). So pictures are unrolled anew, on a plane that
rises along the handle and turns with it. At a wrong steepness they are less alike, and angles go to
and fro as the handle turns: that one is believed at which they are most alike and spins are the
steadiest.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.spin.align import (
    ORDERS,
    Array,
    Complex,
    align,
    product,
    ring_weights,
    rings_seen,
    turned,
)
from curlshot.vision.spin.bearing import bearing
from curlshot.vision.spin.shade import parts, upright_mean

STEEPNESSES = np.round(np.arange(-0.6, 0.61, 0.1), 1)
"""That are tried: how much higher a handle is per length along it; goose-necks have 0.3 to 0.5."""

ASLANT, WIDELY, MOST = 0.35, 2.4, 48
"""Slant of the view, turn of the stone, rad, and pictures: from which on it is asked, and how many
of them are looked at."""

LEAST, BETTER = 0.2, 0.33
"""From which on a handle is steep, and what share of what is unlike in pictures times what is
unsteady in angles that must take away. Of drawn stones that turned so widely 25 of 34 that rise by
0.3 are told to, by 0.19 to 0.43, five of nine that rise by 0.15, and none of 43 level ones. What is
unlike alone mostly differs by a tenth or less, and in some favours the other sense."""

TOLD = 0.1
"""How well steepnesses are told, a standard error."""

A_WHILE, PUSHED, STANDS, SURE = 0.25, 0.1, 0.05, 0.005
"""Time over which a speed is told, s; by which share of its greatest speed a stone that is hit
changes its velocity, and below which it stands; and what angles are off by at least, rad."""

RAYS, FINER = 64, 4
"""Directions, and places from ring to ring, between which pictures are interpolated."""


def inclined(
    pictures: Complex, angles: Array, radii: Array, slants: Array, rise: complex
) -> Complex:
    """Unroll pictures of a cap anew, on a plane that rises and turns with it.

    Parameters
    ----------
    pictures, angles, radii, slants
        As for `curlshot.vision.spin.pitch.levelled`.
    rise : complex
        How steep the plane is, and in which direction, of a cap at angle 0.

    Returns
    -------
    ndarray, shape (n, orders, rings, channels)
    """
    out = np.empty_like(pictures)
    for part in parts(np.arange(len(pictures))):
        fine, seen = _finely(pictures[part], radii), rings_seen(pictures[part])
        out[part] = _on_plane(fine, seen, radii, slants[part], rise * np.exp(1j * angles[part]))
    return out


def rise_of_handle(
    times: Array, pictures: Complex, angles: Array, radii: Array, slants: Array, sd_shift: Array
) -> complex | None:
    """Tell how steeply a handle rises along itself, if it is seen aslant and turns widely.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    pictures, angles, radii, slants
        As for `inclined`.
    sd_shift : ndarray, shape (n,)
        As for `curlshot.vision.spin.align.align`.

    Returns
    -------
    complex or None
        How steep it is, and in which direction, of a cap at angle 0; None where nothing is told.
    """
    glide = _glides(times, slants)
    # A stone that stands has no steady spin, and its pictures are alike at any steepness.
    goes = np.flatnonzero(glide >= 0)
    if np.median(np.hypot(*slants[goes].T)) < ASLANT or np.ptp(angles[goes]) < WIDELY:
        return None
    shown = rings_seen(pictures)[:, None, :, None]
    direction = bearing(upright_mean(pictures, angles, shown))
    if direction is None:
        return None
    along = np.exp(1j * direction)
    some = goes[np.linspace(0, len(goes) - 1, min(len(goes), MOST)).astype(int)]
    pictures, angles, slants, sd_shift = pictures[some], angles[some], slants[some], sd_shift[some]
    times, glide = times[some], glide[some]
    fine, seen, uphill = _finely(pictures, radii), rings_seen(pictures), along * np.exp(1j * angles)
    planes = (_on_plane(fine, seen, radii, slants, steep * uphill) for steep in STEEPNESSES)
    turns, unlike = zip(*(_aligned(p, angles, radii, sd_shift) for p in planes), strict=True)
    odd, middle = np.array(unlike), len(unlike) // 2
    # What is not interpolated keeps all its noise.
    odd[middle] = min(odd[middle], odd[[middle - 1, middle + 1]].mean())
    odd *= [_unsteady(times, turn, glide) for turn in turns]
    best = int(odd.argmin())
    if abs(STEEPNESSES[best]) < LEAST or best in (0, len(odd) - 1):
        return None
    if odd[best] > (1 - BETTER) * odd[middle]:
        return None
    before, at, after = np.log(odd[best - 1 : best + 2])
    beside = 0.5 * (before - after) / (before - 2 * at + after)
    steep = STEEPNESSES[best] + beside * (STEEPNESSES[1] - STEEPNESSES[0])
    return complex(steep * along)


def _aligned(
    pictures: Complex, angles: Array, radii: Array, sd_shift: Array
) -> tuple[Array, float]:
    """Angles of pictures, and the sum of the shares of them that their mean does not explain."""
    angles = align(pictures, angles, radii, sd_shift).angle
    seen = rings_seen(pictures)[:, None, :, None]
    mean = upright_mean(pictures, angles, seen)[1:-1] * seen
    upright = turned(pictures, -angles)[:, 1:-1]
    size = product(upright, upright) * product(mean, mean)
    unlike = float((1 - product(upright, mean) ** 2 / np.maximum(size, 1e-20)).sum())
    return angles, max(unlike, 1e-9)


def _unsteady(times: Array, angles: Array, glide: NDArray[np.intp]) -> float:
    """Sum of squares by which angles are off those of a spin that is constant in each glide."""
    out = len(angles) * SURE**2
    for k in np.unique(glide):
        own = glide == k
        line = np.stack([np.ones(own.sum()), times[own]], axis=1)
        out += float(np.linalg.lstsq(line, angles[own], rcond=None)[1].sum())  # 0 of two pictures
    return out


def _glides(times: Array, slants: Array) -> NDArray[np.intp]:
    """Tell which glide pictures are of, from hit to hit, by how the slant goes: numbers, (n,).

    Of a stone that stands they are -1.
    """
    when = times + A_WHILE * np.array([[-1.0], [0.0], [1.0]])
    ways = np.diff([np.interp(when, times, along) for along in slants.T], axis=1)
    before, after = ways.swapaxes(0, 1)
    change = np.hypot(*(after - before))
    change[(times < times[0] + A_WHILE) | (times > times[-1] - A_WHILE)] = 0.0
    least = PUSHED * np.hypot(*after).max()
    hits = np.zeros(len(times), np.intp)
    while change.max() > least:
        hit = int(change.argmax())
        hits[hit] = 1
        change[np.abs(times - times[hit]) < A_WHILE] = 0.0
    way = np.hypot(*(before + after))
    return np.where(way < STANDS * way.max(), -1, np.cumsum(hits))


def _finely(pictures: Complex, radii: Array) -> Array:
    """Values of some pictures on `RAYS` rays and, from ring to ring, at `FINER` places."""
    rings, seen = len(radii), rings_seen(pictures)
    spectrum = np.zeros((len(pictures), RAYS // 2 + 1, *pictures.shape[2:]), np.complex64)
    spectrum[:, ORDERS] = pictures * RAYS / ring_weights(radii)[:, None]
    plain = np.fft.irfft(spectrum, RAYS, axis=1).astype(np.float32)
    # Where a ring is not seen the nearest of those that are goes on.
    apart = np.abs(np.subtract.outer(np.arange(rings), np.arange(rings)))
    shown = np.where(seen[:, None, :], apart, rings).argmin(2)
    plain = np.take_along_axis(plain, shown[:, None, :, None], axis=2)
    return np.asarray(np.matmul(_between(rings), plain))


def _on_plane(
    fine: Array,
    seen: NDArray[np.bool_],
    radii: Array,
    slants: Array,
    uphill: NDArray[np.complex128],
) -> Complex:
    """Unroll what `_finely` gives on planes that rise by `uphill`: harmonics of the rings seen."""
    aside = slants @ np.array([1, 1j])
    place = radii * np.exp(2j * np.pi * np.arange(RAYS) / RAYS)[:, None]
    height = (uphill.conj()[:, None, None] * place).real
    from_where = place + aside[:, None, None] * height
    step = (radii[1] - radii[0]) / FINER
    out = np.clip((np.abs(from_where) - radii[0]) / step, 0, fine.shape[2] - 1.001)
    around = np.angle(from_where) / (2 * np.pi) * RAYS % RAYS
    ring, ray = out.astype(np.intp), around.astype(np.intp)
    more = (out - ring)[..., None].astype(np.float32)
    beside = (around - ray)[..., None].astype(np.float32)
    own, ray, after = np.arange(len(fine))[:, None, None], ray % RAYS, (ray + 1) % RAYS
    inner = (1 - beside) * fine[own, ray, ring] + beside * fine[own, after, ring]
    outer = (1 - beside) * fine[own, ray, ring + 1] + beside * fine[own, after, ring + 1]
    unrolled = np.fft.rfft((1 - more) * inner + more * outer, axis=1)[:, ORDERS] / RAYS
    return np.asarray(
        unrolled * ring_weights(radii)[:, None] * seen[:, None, :, None], np.complex64
    )


@lru_cache(maxsize=4)
def _between(rings: int) -> Array:
    """Matrix that interpolates between rings, (finer, rings): cubic convolution (Keys, 1981)."""
    fine = np.arange((rings - 1) * FINER + 1) / FINER
    out = np.zeros((len(fine), rings))
    for ring in range(-1, rings + 1):  # the outermost go on
        x = np.abs(fine - ring)
        near, far = (1.5 * x - 2.5) * x**2 + 1, ((-0.5 * x + 2.5) * x - 4) * x + 2
        out[:, min(max(ring, 0), rings - 1)] += np.where(x < 1, near, np.where(x < 2, far, 0.0))
    return out.astype(np.float32)
