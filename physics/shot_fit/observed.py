"""From detections and the fit of their pieces to a shot that a whole fit can begin with."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from curlshot.data.results import Estimate
from curlshot.data.sheet import curling_size
from curlshot.physics.curl import FCV1Curl
from curlshot.physics.filter.slowing import V_C
from curlshot.physics.local_fit.noise import Noise, noises
from curlshot.physics.local_fit.solution import LocalFit
from curlshot.physics.local_fit.spins import spin_on
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.local_fit.untold import SUDDEN
from curlshot.physics.shot_fit.priors import SPIN, Priors
from curlshot.physics.shot_fit.shot_model import ObservedShot, SpinSeen, Unknown

Floats = NDArray[np.float64]

STOPPING = 1.0
"""Deceleration that no ice gives a stone, m/s²."""

SPIN_DRIFT = 0.03
"""How much a spin may change by itself from where it is seen to a hit, rad/s."""

SLIPPERIEST = 1e-3
"""Friction of ice below any that is known. With much less stones would glide for minutes and turn
many times: places from a curve of so few cells do not move as its velocities say, and stones that
lean on each other would be set apart thousands of times in a fit that is going astray."""

SLIDING = 0.02
"""Friction between two stones that a fit sets out from: low, so that they slide. Once they
stick, more of it changes nothing and no slope leads back."""

THROWN = 1.5
"""Spin that a fit sets out from where none is seen before a hit, rad/s: from a spin of nothing,
which may be lost before the hit, no slope leads to another."""

RESTED = 2.0
"""Time for which a stone at rest says where it is, before the shot and after its way, s. What it
says for longer is how its errors last: a minute of it would outweigh all that moves."""

NEAR_HIT = 1.0
"""Time beside a hit in whose middle a spin is told, s: far enough from where it changes."""


def observe(
    known: Mapping[str, Trace],
    fit: LocalFit,
    radius: float,
    *,
    priors: Priors,
    masses: Mapping[str, float] | None = None,
    bystanders: Sequence[str] = (),
) -> ObservedShot | None:
    """Gather what a whole fit needs: detections, first guesses, spins and the order of hits.

    A stone counts until something else than ice and hits moves it, and so do those that it
    hits after that. One that lies still at first and is set off by what no hit tells counts as
    long as it lies.

    Parameters
    ----------
    known : mapping
        Stone to its detections.
    fit : LocalFit
        Of the pieces of all stones that move.
    radius : float
        Of the discs, m.
    priors : Priors
        What is known beforehand.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.
    bystanders : sequence of str
        Stones that rest throughout and may be in the way.

    Returns
    -------
    ObservedShot or None
        None where no stone moves.
    """
    runs = {name: _without_slip(fit, run, known[name]) for name, run in _runs(fit).items()}
    runs = {name: run for name, run in runs.items() if run}
    set_off = _set_off(fit, runs)
    lie = {name: fit.pieces[run[0]].end for name, run in runs.items() if fit.pieces[run[0]].rest}
    lie |= set_off
    ends = _ends(fit, runs, set_off)
    times = [fit.time(k) for k in range(len(fit.meetings))]
    told = [
        k
        for k, meeting in enumerate(fit.meetings)
        if all(times[k] < ends[stone] for stone in meeting.stones)
    ]
    order = sorted(told, key=lambda k: times[k])
    hit = {stone for k in order for stone in fit.meetings[k].stones}
    # Who comes into view on its way after a hit was hit out of sight: from where nobody knows.
    late = min([*(times[k] for k in order), *ends.values()], default=np.inf)
    traces, start = _traces(known, fit, runs, ends, hit, bystanders, late, lie)
    if not traces:
        return None
    noise = noises(fit, known)
    states: list[Unknown] = []
    spins: list[SpinSeen] = []
    for name in traces:
        run = runs.get(name, [])
        seen = [_seen(fit, rank, known, noise, ends[name]) for rank in run]
        spins += [spin for of_piece in seen for spin in of_piece]
        states += _state(name, known[name], fit, run, start, lie.get(name))
        if run and name not in lie:
            first = seen[0][0].omega if seen[0] else THROWN
            states.append(Unknown(f"{name}.omega", first, prior=SPIN))
    return ObservedShot(
        traces,
        start,
        (*_laws(priors, radius), *states),
        tuple(spins),
        tuple(_pair(fit.meetings[k].stones) for k in order),
        tuple(times[k] for k in order),
        radius,
        masses or {},
    )


def _laws(priors: Priors, radius: float) -> tuple[Unknown, ...]:
    """Unknowns of the laws that all stones obey."""
    curling = curling_size(radius)
    least = SLIPPERIEST if curling else 1e-5
    laws = (
        Unknown("restitution", _mean(priors.restitution), 0.0, 1.5, priors.restitution),
        Unknown("stone_friction", SLIDING, 0.0, 2.0, priors.stone_friction),
        Unknown("friction", _mean(priors.friction), least, 1.0, priors.friction),
        Unknown("slope", 0.0, 0.0, 0.02, priors.slope),
        Unknown("v_c", V_C, 0.005, 0.5, priors.v_c),
        Unknown("turn", 0.0, -0.1, 0.1, priors.turn),
        Unknown("size", 1.0, 0.7, 1.3, priors.size),
    )
    if not curling:  # other discs may be of any make, and glide on anything
        return laws
    return (
        *laws,
        Unknown("loss", _mean(priors.loss), 0.0, 0.2, priors.loss),
        Unknown("inertia", _mean(priors.inertia), 0.3, 0.6, priors.inertia),
    )


def _traces(
    known: Mapping[str, Trace],
    fit: LocalFit,
    runs: Mapping[str, Sequence[int]],
    ends: Mapping[str, float],
    hit: Collection[str],
    bystanders: Sequence[str],
    late: float,
    lie: Collection[str],
) -> tuple[dict[str, Trace], float]:
    """Return detections that count, by stone, and when the shot begins, s.

    Of those that move or are `hit`, till they `end` or rest, but for those that come into view
    after `late` and are not hit; and of bystanders, as long as the shot lasts. Some `lie` at first.
    """
    counted = {}
    for name, run in runs.items():
        if name in hit or not fit.pieces[run[0]].rest:
            shown = known[name].until(min(ends[name], _rested(fit, run, known[name])))
            if len(shown.t):
                counted[name] = shown
    if not counted:
        return {}, np.nan
    counted |= {name: known[name] for name in bystanders if len(known[name].t)}
    # Back from there stones at rest stay, however long they are seen; others would not.
    come = [name for name in counted if name in runs and name not in lie]
    start = min(float(counted[name].t[0]) for name in come or counted)
    left_out = {name for name in come if counted[name].t[0] > late} - set(hit)
    return {
        name: trace.since(start - RESTED) for name, trace in counted.items() if name not in left_out
    }, start


def _mean(estimate: Estimate) -> float:
    return float(estimate.value or 0.0)


def _pair(stones: tuple[str, str]) -> tuple[str, str]:
    first, second = sorted(stones)
    return first, second


def _runs(fit: LocalFit) -> dict[str, list[int]]:
    """Ranks of each stone's pieces in order of time."""
    out: dict[str, list[int]] = {}
    for rank, piece in enumerate(fit.pieces):
        out.setdefault(piece.stone, []).append(rank)
    return {name: sorted(run, key=lambda r: fit.pieces[r].start) for name, run in out.items()}


def _without_slip(fit: LocalFit, run: list[int], trace: Trace) -> list[int]:
    """Leave out a first piece after which a stone rests sooner than ice can stop it.

    Its places went astray there, as in the blend of two views.
    """
    first = fit.pieces[run[0]]
    moves_on = any(
        fit.pieces[rank].start <= first.end and not fit.pieces[rank].rest for rank in run[1:]
    )
    if first.rest or first.closes is not None or not np.isfinite(first.end) or moves_on:
        return run
    start = float(trace.t[first.samples[0]]) if len(first.samples) else first.start
    _, speed = fit.motion(run[0], start)
    return run[1:] if float(np.hypot(*speed)) > STOPPING * (first.end - start) else run


def _set_off(fit: LocalFit, runs: Mapping[str, Sequence[int]]) -> dict[str, float]:
    """Tell when stones that lay still are set off by what no hit tells, while others move, s.

    Such a rest is no piece of the fit, for no hit bounds it. Taken for on its way from the start,
    the stone would come through all that lies in its back: a fit from there never follows the shot,
    and each of its simulations has stones that lean on each other by the hundred.
    """
    pieces = fit.pieces
    moving = (pieces[rank].start for run in runs.values() for rank in run if not pieces[rank].rest)
    begin = min(moving, default=np.inf)
    firsts = {name: run[0] for name, run in runs.items() if pieces[run[0]].opens is None}
    return {
        name: pieces[rank].start
        for name, rank in firsts.items()
        if not pieces[rank].rest and pieces[rank].start > begin and _jumps(fit, None, rank)
    }


def _ends(
    fit: LocalFit, runs: Mapping[str, Sequence[int]], set_off: Mapping[str, float]
) -> dict[str, float]:
    """Find when something else than ice and hits moves each stone; infinity if never."""
    ends = dict.fromkeys(runs, np.inf) | dict(set_off)
    for name, run in runs.items():
        for one, two in pairwise(run):
            if fit.pieces[two].opens is None and _jumps(fit, one, two):
                ends[name] = min(ends[name], fit.pieces[two].start)
                break
    order = sorted(range(len(fit.meetings)), key=fit.time)
    for k in order:  # who is hit by such a stone is no longer told either
        stones = fit.meetings[k].stones
        if any(ends[stone] < fit.time(k) for stone in stones):
            for stone in stones:
                ends[stone] = min(ends[stone], fit.time(k))
    return ends


def _rested(fit: LocalFit, run: Sequence[int], trace: Trace) -> float:
    """Time, s, by which a stone has been at rest for `RESTED` after its last motion."""
    last = fit.pieces[run[-1]]
    if last.rest:
        return (last.start if np.isfinite(last.start) else float(trace.t[-1])) + RESTED
    return fit.stop(run[-1]) + RESTED


def _jumps(fit: LocalFit, one: int | None, two: int) -> bool:
    """Whether the velocity changes from a piece, or rest, to the next by more than is uncertain."""
    t = fit.pieces[two].start
    speeds, variance = [], 0.0
    for rank in (one, two):
        if rank is None:
            speeds.append(np.zeros(2))
            continue
        piece = fit.pieces[rank]
        tau = t - fit.origins[rank]
        speeds.append(np.zeros(2) if piece.rest else fit.motion(rank, t)[1])
        row = np.array([0.0, 1.0, tau])
        for axis in range(2):
            at = fit.unknowns(rank)[3 * axis : 3 * axis + 3]
            variance += float(row @ fit.cov[np.ix_(at, at)] @ row)
    change = float(np.hypot(*(speeds[1] - speeds[0])))
    return bool(change > SUDDEN + 4 * np.sqrt(variance))


def _state(
    name: str,
    trace: Trace,
    fit: LocalFit,
    run: Sequence[int],
    start: float,
    lies: float | None,
) -> list[Unknown]:
    """Unknowns of one stone's state at the start of the shot, guessed from its first piece.

    It `lies` still until a time, s, if it is one that does at first.
    """
    if not run or lies is not None:
        early = trace.xy if lies is None else trace.xy[trace.t < lies]
        place = np.median(early, axis=0) if len(early) else fit.state(run[0])[:, 0]
        return [Unknown(f"{name}.{key}", float(v)) for key, v in zip("xy", place, strict=True)]
    place, speed = fit.motion(run[0], start)
    values = (*place.tolist(), *speed.tolist())
    return [
        Unknown(f"{name}.{key}", value)
        for key, value in zip(("x", "y", "vx", "vy"), values, strict=True)
    ]


def _seen(
    fit: LocalFit, rank: int, known: Mapping[str, Trace], noise: Mapping[str, Noise], end: float
) -> list[SpinSeen]:
    """Spin on one piece beside the first of the hits that bound it, or beside its start.

    All its angles have a say in it, so that there is no second one to be had.
    """
    piece = fit.pieces[rank]
    seen = known[piece.stone].t[piece.samples]
    if piece.rest or piece.start >= end or not len(seen):
        return []
    hits = [fit.time(k) for k in (piece.opens, piece.closes) if k is not None]
    near = seen[np.abs(seen - (hits or seen)[0]) < NEAR_HIT]
    middle = float(np.mean(near)) if len(near) else np.inf
    spin = spin_on(fit, rank, known, noise, middle) if middle < end else Estimate()
    if spin.value is None or spin.stderr is None:
        return []
    # Ice takes about so much spin from a stone: how that hangs on its speed is not certain.
    away = abs(middle - (hits or seen)[0])
    speed = float(np.hypot(*fit.motion(rank, middle)[1]))
    lost = float(FCV1Curl().spin_loss(speed)) * away
    sd = float(np.sqrt(spin.stderr**2 + SPIN_DRIFT**2 + lost**2))
    return [SpinSeen(piece.stone, middle, spin.value, sd)]
