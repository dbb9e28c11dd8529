"""How a stone is turned: its cap's picture against the clip's own picture of that cap.

A cap is described by its angular harmonics on rings about the centre. Turning the stone by
δ multiplies the harmonic k by exp(−i k δ), so the angle that brings two pictures together
is the maximum of their circular cross-correlation, found to a fraction of a sample. Every
frame is measured against the mean of all frames, so errors do not add up along the clip.
The mean over the angle (k = 0) says nothing; k = 1 is left out because a centre that is
slightly off and light from one side look like it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex64]

HARMONICS = np.arange(2, 17)
_RINGS = 8
_GRID = 1440
_LEAST_SCALE = 4.0
"""How much larger errors are at least than if every ring and harmonic erred for itself."""


@dataclass(frozen=True)
class Turning:
    """How angles are followed.

    Attributes
    ----------
    reach : float
        How far from the expected angle a stone is looked for, rad.
    most_spin : float
        How much that reach grows per second without a sighting, rad/s.
    least_likeness : float
        Correlation (0 to 1) with the stone's own picture below which nothing is said.
    rounds : int
        How often the mean picture is built anew.
    """

    reach: float = 0.30
    most_spin: float = 3.0
    least_likeness: float = 0.45
    rounds: int = 3


TURNING = Turning()


def cap_spectrum(patch: NDArray[np.uint8], inner: float, outer: float) -> Complex:
    """Angular harmonics of a cap.

    Parameters
    ----------
    patch : ndarray, shape (rays, radii, channels)
        Colours on rays counter-clockwise from the x axis.
    inner, outer : float
        Range of radii to use, as shares of the patch's radii, 0 to 1.

    Returns
    -------
    ndarray, shape (harmonics, rings * channels)
        Rings weigh as their length does.
    """
    radii = patch.shape[1]
    first, last = round(inner * radii), round(outer * radii)
    edges = np.linspace(first, last, min(_RINGS, last - first) + 1).astype(int)
    counts = np.diff(edges)
    sums = np.add.reduceat(patch[:, : edges[-1]].astype(np.float32), edges[:-1], axis=1)
    rings = sums / counts[None, :, None]
    spectrum = np.fft.rfft(rings, axis=0)[HARMONICS] / patch.shape[0]
    weight = np.sqrt((edges[:-1] + edges[1:]) / 2 / edges[-1])
    weighted = spectrum * weight[None, :, None]
    return np.asarray(weighted.reshape(len(HARMONICS), -1), np.complex64)


def turned(spectrum: Complex, angle: float) -> Complex:
    """Spectrum of the same cap turned counter-clockwise by `angle`."""
    return np.asarray(spectrum * np.exp(-1j * HARMONICS * angle)[:, None], np.complex64)


def angle_between(
    reference: Complex, spectrum: Complex, expected: float, reach: float
) -> tuple[float, float, float]:
    """Angle by which one cap is turned against a reference: `angles_between` of one."""
    found = angles_between(reference, spectrum[None], np.array([expected]), reach)
    angle, sd, likeness = (float(values[0]) for values in found)
    return angle, sd, likeness


def angles_between(
    reference: Complex, spectra: Complex, expected: Array, reach: float
) -> tuple[Array, Array, Array]:
    """Angles by which caps are turned against a reference.

    Parameters
    ----------
    reference : ndarray, shape (harmonics, rings * channels)
    spectra : ndarray, shape (n, harmonics, rings * channels)
    expected : ndarray, shape (n,)
        About where the angles are sought, rad.
    reach : float
        How far from there, rad.

    Returns
    -------
    angle, sd, likeness : ndarray, shape (n,)
        Angles nearest to what was expected, rad; their standard errors from what the two
        pictures do not share; correlations of the two pictures, 0 to 1.
    """
    cross = (np.conj(reference) * spectra).sum(2).astype(complex)
    size = np.linalg.norm(reference)
    sizes = np.linalg.norm(spectra, axis=(1, 2))
    blank = size * sizes <= 0
    energy = np.where(blank, 1.0, size * sizes)
    offset = np.linspace(-reach, reach, max(int(_GRID * reach / np.pi), 9))
    near = cross * np.exp(1j * HARMONICS * expected[:, None])
    value = (near @ np.exp(1j * HARMONICS[:, None] * offset)).real
    angle = expected + offset[value.argmax(1)]
    for _ in range(4):  # Newton's method on a sum of cosines
        phase = cross * np.exp(1j * HARMONICS * angle[:, None])
        slope, bend = -phase.imag @ HARMONICS, -phase.real @ HARMONICS**2
        step = -slope / np.where(bend < 0, bend, -np.inf)
        angle = angle + np.clip(step, -0.05, 0.05)
    aligned = np.exp(-1j * HARMONICS * angle[:, None])
    likeness = (cross / aligned).real.sum(1) / energy
    gain = np.maximum(likeness, 0.0) * sizes / max(size, 1e-12)
    model = (gain[:, None] * aligned).astype(np.complex64)[..., None] * reference
    rest = (np.abs(spectra - model) ** 2).sum((1, 2))
    sharpness = gain**2 * float((HARMONICS[:, None] ** 2 * np.abs(reference) ** 2).sum())
    sd = np.sqrt(rest / (2 * reference.size) / np.maximum(sharpness, 1e-12))
    nothing = np.where(blank, np.nan, 0.0)
    return angle + nothing, sd + nothing, np.where(blank, 0.0, likeness)


def handle_angles(
    times: Array, spectra: Sequence[Complex | None], turning: Turning = TURNING
) -> tuple[Array, Array]:
    """Angle of one stone in every frame, continuous, its zero in the first frame seen.

    Parameters
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    spectra : sequence of ndarray or None
        From `cap_spectrum`; None where the cap is not seen well.

    Returns
    -------
    theta, sd : ndarray, shape (n,)
        rad; NaN where it cannot be told.
    """
    n = len(times)
    theta, sd = np.full(n, np.nan), np.full(n, np.nan)
    seen: list[int] = [index for index in range(n) if spectra[index] is not None]
    if len(seen) < 2:  # an angle is against another picture of the same stone
        return theta, sd
    likeness = np.zeros(n)
    picture = np.array(spectra[seen[0]], np.complex64)
    theta[seen[0]], likeness[seen[0]] = 0.0, 1.0
    before, spin, weight = seen[0], 0.0, 1.0
    for index in seen[1:]:
        spectrum = spectra[index]
        assert spectrum is not None
        wait = times[index] - times[before]
        reach = min(turning.reach + turning.most_spin * wait, 1.5)
        angle, _, like = angle_between(picture, spectrum, theta[before] + spin * wait, reach)
        likeness[index] = like
        if not like > turning.least_likeness:
            continue
        spin += 0.3 * ((angle - theta[before]) / wait - spin)
        theta[index], before = angle, index
        weight += 1.0
        picture += (turned(spectrum, -angle) - picture) / min(weight, 30.0)
    for _ in range(turning.rounds):
        known = np.flatnonzero(np.isfinite(theta))
        picture = _mean_picture(spectra, theta, known)
        seen_then = np.array([spectra[index] for index in known.tolist()])
        theta[known], sd[known], likeness[known] = angles_between(
            picture, seen_then, theta[known], 0.2
        )
    told = np.isfinite(theta) & (likeness > turning.least_likeness)
    if told.sum() < 0.5 * len(seen):
        # Most frames do not look like the mean: there is nothing on the cap to go by.
        told[:] = False
    theta[~told], sd[~told] = np.nan, np.nan
    sd *= _jitter(times, theta, sd)
    if told.any():
        theta -= theta[told][0]
    return theta, sd


def _jitter(times: Array, theta: Array, sd: Array) -> float:
    """How many times larger than claimed the errors are.

    The errors of rings and colours hang together, by how much depends on the clip: so the
    scale is that of the angles about a steady turning in three frames in a row. Errors that
    last for longer (light, the handle's height) make it about twice that. What of the pictures
    does not turn with a slowly turning stone lasts longest and scatters least: hence a floor.
    """
    step = np.diff(times)
    bend = theta[2:] - 2 * theta[1:-1] + theta[:-2]
    steady = np.isfinite(bend) & (np.abs(step[1:] - step[:-1]) < 0.2 * step[:-1])
    if steady.sum() < 5:
        return 5.0
    scatter = 1.4826 * float(np.median(np.abs(bend[steady]))) / np.sqrt(6)
    return float(max(2 * scatter / max(float(np.nanmedian(sd)), 1e-6), _LEAST_SCALE))


def _mean_picture(
    spectra: Sequence[Complex | None], theta: Array, known: NDArray[np.intp]
) -> Complex:
    total = np.zeros_like(np.asarray(spectra[known[0]]))
    for index in known.tolist():
        spectrum = spectra[index]
        assert spectrum is not None
        total += turned(spectrum, -theta[index])
    return np.asarray(total / len(known), np.complex64)
