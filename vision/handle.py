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
    """Angle by which a cap is turned against a reference.

    Returns
    -------
    angle, sd, likeness : float
        Angle nearest to what was expected, rad; its standard error from what the two
        pictures do not share; correlation of the two pictures, 0 to 1.
    """
    cross = (np.conj(reference) * spectrum).sum(1).astype(complex)
    energy = float(np.linalg.norm(reference) * np.linalg.norm(spectrum))
    if energy <= 0:
        return float("nan"), float("nan"), 0.0
    trial = expected + np.linspace(-reach, reach, max(int(_GRID * reach / np.pi), 9))
    value = (np.exp(1j * HARMONICS * trial[:, None]) @ cross).real
    angle = float(trial[value.argmax()])
    for _ in range(4):  # Newton's method on a sum of cosines
        phase = cross * np.exp(1j * HARMONICS * angle)
        slope = -(HARMONICS * phase.imag).sum()
        bend = -(HARMONICS**2 * phase.real).sum()
        if bend >= 0:
            break
        angle += float(np.clip(-slope / bend, -0.05, 0.05))
    likeness = float((cross * np.exp(1j * HARMONICS * angle)).real.sum() / energy)
    aligned = turned(reference, angle)
    gain = max(likeness, 0.0) * float(np.linalg.norm(spectrum) / np.linalg.norm(reference))
    rest = float((np.abs(spectrum - gain * aligned) ** 2).sum())
    sharpness = gain**2 * float((HARMONICS[:, None] ** 2 * np.abs(reference) ** 2).sum())
    free = 2 * spectrum.size
    sd = np.sqrt(rest / free / max(sharpness, 1e-12))
    return angle, float(sd), likeness


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
        for index in known.tolist():
            spectrum = spectra[index]
            assert spectrum is not None
            theta[index], sd[index], likeness[index] = angle_between(
                picture, spectrum, theta[index], 0.2
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
    last for longer (light, the handle's height) make it about twice that.
    """
    step = np.diff(times)
    bend = theta[2:] - 2 * theta[1:-1] + theta[:-2]
    steady = np.isfinite(bend) & (np.abs(step[1:] - step[:-1]) < 0.2 * step[:-1])
    if steady.sum() < 5:
        return 5.0
    scatter = 1.4826 * float(np.median(np.abs(bend[steady]))) / np.sqrt(6)
    return float(max(2 * scatter / max(float(np.nanmedian(sd)), 1e-6), 1.0))


def _mean_picture(
    spectra: Sequence[Complex | None], theta: Array, known: NDArray[np.intp]
) -> Complex:
    total = np.zeros_like(np.asarray(spectra[known[0]]))
    for index in known.tolist():
        spectrum = spectra[index]
        assert spectrum is not None
        total += turned(spectrum, -theta[index])
    return np.asarray(total / len(known), np.complex64)
