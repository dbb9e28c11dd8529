"""Stretches of tracks that the simulated shot does not follow, and a fit that leaves them out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import attrgetter

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from curlshot.data.results import TrackResidual
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.shot_fit.model_selection import fit_with_chosen_laws
from curlshot.physics.shot_fit.off_centre import centred
from curlshot.physics.shot_fit.result import ShotFit
from curlshot.physics.shot_fit.shot_model import ObservedShot
from curlshot.physics.statistics.residuals import huber_weights, inflation

Floats = NDArray[np.float64]

DEGREE = 5
"""Of the polynomials in time that a path is looked for to be bent by: bends of a sixth of it."""

EACH = 4
"""Detections for each of their coefficients, at least."""

CERTAIN = 5.0
"""Standard deviations by which a bend is larger than chance makes it: of 100 drawn shots with even
noise no stretch reaches it, of 25 filmed ones none whose stone is where it is said to be."""

ROUNDS = 3
"""How many stones are suspected in turn, at most."""


def fit_without_bent_tracks(shot: ObservedShot) -> ShotFit:
    """Fit a shot with the laws that it asks for, without stretches that are not of stones on ice.

    Someone in front of a stone, another thing that is taken for it, or a hand draw a track aside,
    and what it shows then is no law that all stones share. Its places count less by the square of
    the variance that they are off by, so hardly at all. That is so of one stone after another, the
    worst first, while fewer than half of the stones that move have such a stretch: of two that
    contradict each other nothing tells which is right.

    Parameters
    ----------
    shot : ObservedShot
        As `curlshot.physics.shot_fit.observed.observe` makes it.

    Returns
    -------
    ShotFit
        With larger errors of these places.
    """
    fit = fit_with_chosen_laws(shot)
    suspects, bent = set[str](), 0
    for _ in range(ROUNDS):
        known = fit.shots[0]
        off = [one for one in track_residuals(known, fit, level=1.0) if one.significant]
        new = [one for one in off if one.stone not in suspects]
        worst = max(new, key=attrgetter("rms_ratio"), default=None)
        if worst is None or 2 * (bent + 1) >= len(_moving(shot)):
            break
        suspects.add(worst.stone)
        # A bent track draws the others along: how noisy they are is told only without it.
        own = [one for one in off if one.stone == worst.stone]
        without = fit_with_chosen_laws(_loosened(known, own))
        far = [
            one
            for one in track_residuals(known, without)
            if one.significant and one.stone == worst.stone
        ]
        if far:
            less = len(far) < len(own)
            fit = fit_with_chosen_laws(_loosened(known, far)) if less else without
            bent += 1
    return fit


def track_residuals(
    shot: ObservedShot, fit: ShotFit, level: float | None = None
) -> tuple[TrackResidual, ...]:
    """How far each stretch of each stone's track is from the path that a fit has it on.

    Paths are smooth, and so is what draws a track aside: what residuals have of low degree in time
    is set against what noise as large and as lasting as that of the other stones would have, where
    the fit counts them, and against the error that places share.

    Parameters
    ----------
    shot : ObservedShot
        The detections, with the errors to judge by.
    fit : ShotFit
        Of that shot, of its beginning, or of the same with larger errors.
    level : float, optional
        Factor on the variances of the places, instead of what the other stones' residuals say.
    """
    simulation = fit.simulation()
    end = np.nextafter(fit.shots[0].end, np.inf)
    traces = {name: shot.traces[name].until(end) for name in fit.shots[0].traces}
    given = replace(shot, traces=traces).residuals(simulation)
    runs = {
        name: centred(trace, run, fit.inflation, shot.sd_off_centre(trace))[0]
        for (name, trace), run in zip(traces.items(), given, strict=True)
    }
    larger = {
        name: fit.shots[0].traces[name].sd[:, 0] > trace.sd[:, 0] for name, trace in traces.items()
    }
    counted = {name: run[~larger[name]] for name, run in runs.items()}
    out = []
    for name, trace in traces.items():
        noise = _noise_of_others(name, counted) if level is None else level
        hits = [path.start + shot.start for path in simulation.paths[name][1:]]
        for rows in np.split(np.arange(len(trace.t)), np.searchsorted(trace.t, hits)):
            if len(rows) >= 2 * EACH:
                out.append(_misfit(trace, runs[name], rows, noise, bool(larger[name][rows].any())))
    return tuple(out)


def _misfit(
    trace: Trace, run: Floats, rows: NDArray[np.intp], level: float, left_out: bool
) -> TrackResidual:
    t = trace.t[rows]
    degree = min(DEGREE, len(rows) // EACH - 1)
    basis = np.linalg.qr(legendre.legvander((t - t[0]) / np.ptp(t) * 2 - 1, degree))[0]
    shared = float(np.sum((trace.sd_place[rows] / trace.sd[rows]) ** 2))
    by_chance = level * 2 * (degree + 1) + shared

    def square(residuals: Floats) -> float:
        return float(np.sum((basis.T @ residuals) ** 2)) / by_chance

    # A few detections far off bend no path; but one that is bent is off by as much as it is.
    off = square(run[rows] * huber_weights(run[rows]))
    certain = bool(off > 1 + CERTAIN / np.sqrt(degree + 1))
    size = float(np.sqrt(square(run[rows]) if certain else off))
    return TrackResidual(trace.stone, float(t[0]), float(t[-1]), size, certain, left_out)


def _noise_of_others(stone: str, runs: Mapping[str, Floats]) -> float:
    """Factor on the variances of places that residuals of the other stones, (n, 2), ask for."""
    others = [(run, 3) for name, run in runs.items() if name != stone and len(run) > 3]
    return inflation(others, sum(2 * (len(run) - 3) for run, _ in others)) if others else 1.0


def _moving(shot: ObservedShot) -> set[str]:
    """Stones that come with a speed, or are hit."""
    thrown = {u.stone for u in shot.unknowns if u.stone and u.name.endswith(".vx")}
    return thrown | {stone for pair in shot.hits for stone in pair}


def _loosened(shot: ObservedShot, bent: Sequence[TrackResidual]) -> ObservedShot:
    """Enlarge the errors of the places of bent stretches."""
    traces = dict(shot.traces)
    for one in bent:
        trace = traces[one.stone]
        rows = (trace.t >= one.t0) & (trace.t <= one.t1)
        larger = np.where(rows[:, None], trace.sd * one.rms_ratio**2, trace.sd)
        traces[one.stone] = replace(trace, sd=larger)
    return replace(shot, traces=traces)
