"""Noise of the detections of a shot: white noise, and errors that are correlated in time.

Light, shadow and where edges fall between pixels change slowly as a stone moves on. The residuals
from a smooth motion tell both parts: the scatter of neighbours is white noise, that of a whole
stretch is both. Codecs take most of a picture from the one before, so that neighbours among many
pictures a second have errors in common: of angles means of such are looked at. A residual larger
than either part explains is taken for a worse detection, unless it is so large that the filter
refuses it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import (
    ANGLE_MEMORY,
    GATE,
    MOST_LOSS_SD,
    PLACE_MEMORY,
    SPIN_LOSS,
    SPIN_LOSS_SD,
)
from curlshot.physics.local_fit.solution import LocalFit
from curlshot.physics.local_fit.traces import Trace, level, local_residuals

Floats = NDArray[np.float64]

FEWEST = 8
"""Detections in a row from which they say how they err."""

ENOUGH = FEWEST + 4
"""Detections in a row of which `FEWEST` have two neighbours on either side."""

BRIEF = 0.04
"""Time after which angles have nothing in common for being neighbours, s. Under H.264 those of
drawn stones err with a correlation of 0.3 if they are 0.017 s apart, of 0.2 if 0.02 s, and with
none from 0.033 s on. So do places, but with means of them fewer lie within two errors (0.96 of
those of 12 clips of 60 pictures a second, not 0.97), though speeds are 3 % nearer."""

FEW = 30
"""Detections of a stone whose scatter says as much of its errors as that of the others does."""

STATED, OTHERS = 1.0, 4.0
"""How many memories of detections say as much of a stone's lasting errors as what is stated of them
does, and as those of the others of its shot do."""

WILD = 3.0
"""Standard deviations beyond which a detection is worse than it says."""

WORSE = 2.0
"""How many times as large as usual an error that lasts may be: what a detection is worse than that,
as one cut by the picture's edge, goes with it, and is no error of the next ones."""

MOST = 60
"""So many detections of a stretch are enough to tell how much of a lasting error a fit takes."""


@dataclass(frozen=True)
class Noise:
    """Standard deviations of the detections of one stone: x, y and θ, (n, 3) each.

    ``white`` is independent from detection to detection, ``slow`` correlated in time.
    """

    white: Floats
    slow: Floats


@dataclass(frozen=True)
class Run:
    """Detections of one stone in one stretch of smooth motion.

    Attributes
    ----------
    stone : str
        Whose.
    samples : (n,) array of int
        Which of its detections.
    t : (n,) array
        Times, s.
    off : (n,) array
        What x, y or θ differ by from the motion, in their stated standard deviations.
    free : float
        How many numbers of the motion they tell.
    each : int
        Of how many detections in a row each of these is the mean.
    """

    stone: str
    samples: NDArray[np.int64]
    t: Floats
    off: Floats
    free: float
    each: int = 1

    def means(self, brief: float) -> Run:
        """Means over a brief time, s; over less where so few were left that they tell nothing."""
        each = min(round(brief / float(np.median(np.diff(self.t)))), len(self.t) // ENOUGH)
        if each < 2:
            return self
        first = np.arange(0, len(self.t) - each + 1, each)
        t, off = (values[first[:, None] + np.arange(each)].mean(1) for values in (self.t, self.off))
        return replace(self, samples=self.samples[first], t=t, off=off, each=each)


def noises(fit: LocalFit, known: Mapping[str, Trace]) -> dict[str, Noise]:
    """Estimate the noise of the detections of each stone.

    Their stated errors are taken for the whole; the scatter says how much of it is white.

    Parameters
    ----------
    fit : LocalFit
        Of all pieces.
    known : mapping
        Stone to its detections.

    Returns
    -------
    dict of str to Noise
        By stone.
    """
    each = [
        _errors(list(_places(fit, known, 0)), known, PLACE_MEMORY),
        _errors(list(_places(fit, known, 1)), known, PLACE_MEMORY),
        _errors(list(_angles(fit, known)), known, ANGLE_MEMORY, BRIEF),
    ]
    out = {}
    for name, trace in known.items():
        stated = np.column_stack([trace.sd, trace.sd_theta])
        white = np.column_stack([errors[name][0] for errors in each])
        slow = np.array([errors[name][1] for errors in each])
        out[name] = _noise(white * stated, slow * _filled(stated))
    return out


def _noise(white: Floats, slow: Floats) -> Noise:
    """Count as white what few detections are much worse by than the others."""
    lasting = np.minimum(slow, WORSE * np.median(slow, axis=0))
    return Noise(np.sqrt(white**2 + slow**2 - lasting**2), lasting)


def _filled(stated: Floats) -> Floats:
    """Fill in what is usual where nothing is seen; 0 where nothing ever is."""
    usual = np.zeros(stated.shape[1])
    seen = np.isfinite(stated).any(0)
    usual[seen] = np.nanmedian(stated[:, seen], axis=0)
    return np.where(np.isfinite(stated), stated, usual)


def _places(fit: LocalFit, known: Mapping[str, Trace], axis: int) -> Iterator[Run]:
    """Places on one axis of each piece that moves against its fit."""
    for i, piece in enumerate(fit.pieces):
        trace, samples = known[piece.stone], piece.samples
        if piece.rest or len(samples) < FEWEST:
            continue
        path = fit.places(i, trace.t[samples])[:, axis]
        off = (trace.xy[samples, axis] - path) / trace.sd[samples, axis]
        yield Run(piece.stone, samples, trace.t[samples], off, 3.0)


def _angles(fit: LocalFit, known: Mapping[str, Trace]) -> Iterator[Run]:
    """Angles of each piece that moves against a steady loss of spin, as large as ice takes it."""
    for i, piece in enumerate(fit.pieces):
        trace = known[piece.stone]
        told = np.isfinite(trace.theta[piece.samples]) & (trace.t[piece.samples] < fit.stop(i))
        samples = piece.samples[told]
        if piece.rest or len(samples) < FEWEST:
            continue
        t, theta, sd = trace.t[samples], trace.theta[samples], trace.sd_theta[samples]
        tau = t - t[0]
        basis = np.stack([np.ones_like(tau), tau, 0.5 * tau * tau], axis=1)
        # What bends more than a stone of that speed loses spin is an error, and one that lasts.
        way = float(np.hypot(*(trace.xy[samples[-1]] - trace.xy[samples[0]])))
        lost = SPIN_LOSS + SPIN_LOSS_SD
        loss = min(lost * tau[-1] / max(way, 1e-6), MOST_LOSS_SD[1])
        alike = max(1.0, 2 * ANGLE_MEMORY / float(np.median(np.diff(t))))
        held = np.array([[0.0, 0.0, np.sqrt(alike) / loss]])
        weight, off = 1 / sd, np.zeros_like(t)
        for _ in range(4):  # what lies far off has less and less of a say
            rows = np.concatenate([weight[:, None] * basis, held])
            curve = np.linalg.lstsq(rows, np.append(weight * theta, 0.0), rcond=None)[0]
            off = (theta - basis @ curve) / sd
            weight = 1 / sd / np.maximum(np.abs(off) / (WILD * level(off[:, None]) + 1e-9), 1.0)
        known_before = held @ np.linalg.inv(rows.T @ rows) @ held.T
        yield Run(piece.stone, samples, t, off, 3.0 - float(known_before[0, 0]))


def _errors(
    runs: Sequence[Run], known: Mapping[str, Trace], memory: float, brief: float = 0.0
) -> dict[str, tuple[Floats, float]]:
    """By stone the size of its white and its lasting errors, relative to what is stated."""
    means = [run.means(brief) for run in runs]
    white = _white_levels(means)
    slow = _lasting_levels(means, white, memory)
    out = {}
    for name, trace in known.items():
        anew, lasting = white.get(name, white[""]), slow.get(name, slow[""])
        each = np.full(len(trace.t), anew)
        for run in (run for run in runs if run.stone == name):
            far = np.abs(run.off) / np.hypot(anew, lasting)
            each[run.samples] *= np.where(far**2 < GATE, np.maximum(far / WILD, 1.0) ** 2, 1.0)
        out[name] = each, lasting
    return out


def _white_levels(runs: Sequence[Run]) -> dict[str, float]:
    """Size of the white noise by stone, and of all under the name ""."""
    scatter: dict[str, list[Floats]] = {}
    for run in runs:
        own = np.sqrt(run.each) * local_residuals(run.t, run.off[:, None])
        for name in (run.stone, ""):
            scatter.setdefault(name, []).append(own)
    joined = {name: np.concatenate(each) for name, each in scatter.items()}
    told = {name: each for name, each in joined.items() if len(each) >= FEWEST}
    if not told:
        return {"": 1.0}
    square = {name: _square(each) for name, each in told.items()}
    return {
        name: float(np.sqrt((len(own) * square[name] + FEW * square[""]) / (len(own) + FEW)))
        for name, own in told.items()
    }


def _square(scatter: Floats) -> float:
    """Mean square of residuals, outliers held to `WILD` standard deviations."""
    most = WILD * level(scatter)
    return float(np.mean(np.clip(scatter, -most, most) ** 2))


def _lasting_levels(
    runs: Sequence[Run], white: Mapping[str, float], memory: float
) -> dict[str, float]:
    """Size of lasting errors by stone, and of all under the name "".

    Their variance is the excess of the residuals' squares over white noise, divided by that of a
    lasting error of unit variance. Little data shrinks a stone towards the others of its shot, and
    a shot towards what is stated.
    """
    sums: dict[str, Floats] = {}
    for run in runs:
        size = white.get(run.stone, white[""])
        usual = WILD * max(1.0, size, level(run.off[:, None]))
        n = len(run.off)
        of_white = size**2 / run.each * (n - run.free)
        excess = float(np.sum(np.clip(run.off, -usual, usual) ** 2)) - of_white
        unit = n * _share_left(run.t, memory)
        weight = float(np.median(np.diff(run.t))) / memory
        for name in (run.stone, ""):
            stated = max(1.0 - white.get(name, white[""]) ** 2, 0.0)
            prior = STATED * np.array([stated, 1.0])
            sums[name] = sums.get(name, prior) + weight * np.array([excess, unit])
    excess, unit = sums.pop("", np.array([0.0, 1.0]))
    usual = max(excess / unit, 0.0)
    held = {
        name: max(excess + OTHERS * usual, 0.0) / (unit + OTHERS)
        for name, (excess, unit) in sums.items()
    }
    return {name: float(np.sqrt(square)) for name, square in ({"": usual} | held).items()}


def _share_left(t: Floats, memory: float) -> float:
    """Share of the variance of a lasting error that a parabola fitted to it leaves."""
    t = t[:: -(-len(t) // MOST)]
    tau = (t - t[0]) / (t[-1] - t[0])
    basis = np.linalg.qr(np.stack([np.ones_like(tau), tau, tau**2], axis=1))[0]
    alike = np.exp(-np.abs(t[:, None] - t) / memory)
    return 1.0 - float(np.einsum("ip,ij,jp", basis, alike, basis)) / len(t)
