"""What a fit of the paths beside the hits says of each hit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.data.results import Estimate, Hit, MeasuredState
from curlshot.physics.local_fit.noise import Noise, noises
from curlshot.physics.local_fit.solution import ContactState, LocalFit
from curlshot.physics.local_fit.spins import spins_at, stone_friction
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.statistics.random_effects import random_effects

Floats = NDArray[np.float64]

WORST = 0.2
"""Standard error of a restitution beyond which a hit is said to tell nothing."""

LOST = 0.2
"""Share of the momentum that no scale, mass or map of the ice is off by: if more of it is lost or
won, beyond three standard errors, something else touched the stones."""

SEEN = 4
"""Detections of a stone on one side of a hit that are enough for its velocity there. By fewer it is
told, between two hits, by their momentum, as if there were no others."""

UNLIKE = 0.05
"""Standard deviation beyond their errors by which restitutions of hits in quick succession differ
where one of them was not told, or not as it was."""


def measure_hits(
    joint: LocalFit,
    apart: LocalFit,
    known: Mapping[str, Trace],
    radius: float,
    masses: Mapping[str, float],
) -> tuple[tuple[Hit, ...], Estimate]:
    """Measure each hit of a fit, and the restitution of all together.

    Parameters
    ----------
    joint, apart : LocalFit
        The fit, with and without the momentum of each pair held.
    known : mapping
        Stone to its detections.
    radius : float
        Of the discs, m.
    masses : mapping
        Stone to mass in any unit; 1 where absent.

    Returns
    -------
    collisions : tuple of Hit
        In the order of the fit's meetings.
    restitution : Estimate
        Pooled over the hits that tell it.
    """
    count = len(joint.meetings)
    mass = [
        np.array([masses.get(stone, 1.0) for stone in meeting.stones]) for meeting in joint.meetings
    ]
    changes = [_momentum(apart, k, mass[k]) for k in range(count)]
    values, cov = joint.propagate(range(count), _restitutions)
    # Paths that are further off than they state do not keep momentum: what shows on its two axes
    # is so in the restitution as well.
    larger = np.array([_birge(_square(change), 2) for change in changes])
    cov *= np.sqrt(np.outer(larger, larger))
    more = _scatter(joint, values, cov)
    cov = cov + np.diag(more**2)
    each = [Estimate(values[k], float(np.sqrt(cov[k, k]))) for k in range(count)]
    notes = [_why_not(joint, k, known, each[k], changes[k], more[k]) for k in range(count)]
    noise = noises(joint, known)
    collisions = tuple(
        _collision(joint, k, known, noise, radius, mass[k], each[k], changes[k], notes[k])
        for k in range(count)
    )
    usable = [k for k, note in enumerate(notes) if note is None]
    return collisions, pooled(values[usable], cov[np.ix_(usable, usable)])


def _collision(
    joint: LocalFit,
    k: int,
    known: Mapping[str, Trace],
    noise: Mapping[str, Noise],
    radius: float,
    mass: Floats,
    restitution: Estimate,
    momentum: Estimate,
    note: str | None,
) -> Hit:
    state = joint.contact_state(k)
    spins = spins_at(joint, k, known, noise, mass)
    before, after = _states(joint, k, known, spins)
    energy = [float(mass @ np.sum(speeds**2, axis=1)) for speeds in (state.before, state.after)]
    rubbing, why = Estimate(), note
    if note is None:
        rubbing, why = stone_friction(joint, k, spins, radius)
    nx, ny = (float(value) for value in state.normal)
    return Hit(
        t=state.t,
        stderr_t=joint.stderr_time(k),
        stones=joint.meetings[k].stones,
        normal=(nx, ny),
        restitution=restitution.value if note is None else None,
        stderr=restitution.stderr if note is None else None,
        before=before,
        after=after,
        momentum_residual=momentum.value,
        stderr_momentum=momentum.stderr,
        energy_lost=1 - energy[1] / energy[0] if energy[0] > 0 else None,
        stone_friction=rubbing.value,
        stderr_stone_friction=rubbing.stderr,
        note=note,
        note_stone_friction=why,
    )


def _states(
    fit: LocalFit, k: int, known: Mapping[str, Trace], spins: Sequence[tuple[Estimate, Estimate]]
) -> tuple[dict[str, MeasuredState], dict[str, MeasuredState]]:
    """States of the two stones before and after hit k, by stone, with their errors."""

    def flat(states: Sequence[ContactState]) -> Floats:
        state = states[0]
        return np.array([state.places, state.before, state.after]).ravel()

    values, cov = fit.propagate([k], flat)
    xy, *speeds = values.reshape(3, 2, 2)
    spread, *errors = np.sqrt(np.diag(cov)).reshape(3, 2, 2)
    out: tuple[dict[str, MeasuredState], dict[str, MeasuredState]] = ({}, {})
    for i, stone in enumerate(fit.meetings[k].stones):
        trace = known[stone]
        # What all places near each other share is no scatter that the fit could see.
        shared = trace.sd_place[np.argmin(np.abs(trace.t - fit.time(k)))]
        place = (*xy[i].tolist(), *np.hypot(spread[i], shared).tolist())
        for when, side in enumerate(out):
            side[stone] = _state(place, speeds[when][i], errors[when][i], spins[i][when])
    return out


def _state(
    place: tuple[float, float, float, float], speed: Floats, sd: Floats, spin: Estimate
) -> MeasuredState:
    (x, y, sd_x, sd_y), (vx, vy), (sd_vx, sd_vy) = place, speed.tolist(), sd.tolist()
    return MeasuredState(x, y, vx, vy, spin.value, sd_x, sd_y, sd_vx, sd_vy, spin.stderr)


def _restitutions(states: Sequence[ContactState]) -> Floats:
    out = []
    for state in states:
        closing = (state.before[0] - state.before[1]) @ state.normal
        leaving = (state.after[1] - state.after[0]) @ state.normal
        out.append(leaving / closing)
    return np.array(out)


def _scatter(fit: LocalFit, values: Floats, cov: Floats) -> Floats:
    """By how much restitutions of hits in quick succession differ beyond their errors, per hit.

    A hit that was not told changes what momentum says of those beside it, some by more and some by
    less, which shows in nothing else.
    """
    out = np.zeros(len(values))
    for group in _successions(fit):
        hits = [k for k in group if cov[k, k] < WORST**2]
        out[hits] = random_effects(values[hits], cov[np.ix_(hits, hits)]).spread
    return out


def _successions(fit: LocalFit) -> list[list[int]]:
    """Ranks of the hits by groups: those between which a stone is hardly seen are in one."""
    group = list(range(len(fit.meetings)))
    for piece in fit.pieces:
        if piece.opens is not None and piece.closes is not None and len(piece.samples) < SEEN:
            one, other = group[piece.opens], group[piece.closes]
            group = [one if g == other else g for g in group]
    return [[k for k, g in enumerate(group) if g == first] for first in sorted({*group})]


def _why_not(
    fit: LocalFit,
    k: int,
    known: Mapping[str, Trace],
    restitution: Estimate,
    momentum: Estimate,
    scatter: float,
) -> str | None:
    """Why a hit cannot tell its restitution; None where it can."""
    value, stderr = (
        np.nan if number is None else number for number in (restitution.value, restitution.stderr)
    )
    if scatter > UNLIKE:
        return (
            "restitution unknown: the values of hits in quick succession would differ by"
            f" {scatter:.2g}, as if a hit between them was missed"
        )
    if value > 1 + 2 * stderr:
        return (
            f"restitution unknown: {value:.3f} ± {stderr:.3f} is more than 1, which no hit gives:"
            " times or tracks are wrong, or something pushed a stone"
        )
    lost = _lost(momentum)
    if lost or stderr < WORST:
        return lost
    for stone in fit.meetings[k].stones:
        for rank, when in zip(fit.sides[k, stone], ("before", "after"), strict=True):
            piece = fit.pieces[rank]
            seen = len(piece.samples)
            if seen < SEEN:
                between = piece.opens is not None and piece.closes is not None
                often = ("not seen", "measured once", f"measured {seen} times")[min(seen, 2)]
                where = "between two hits" if between else f"{when} it"
                return f"restitution unknown: {stone} is {often} {where}"
    return f"restitution unknown: its standard error would be {stderr:.2g}"


def _lost(momentum: Estimate) -> str | None:
    """Say so where so much momentum is lost or won that not only the two stones touched."""
    change, stderr = momentum.value, momentum.stderr
    if change is None or stderr is None or change < max(LOST, 3 * stderr):
        return None
    off = f"{100 * change:.0f} % ± {100 * stderr:.0f} %"
    return f"restitution unknown: momentum changes by {off}; something else touched the stones"


def _momentum(fit: LocalFit, k: int, mass: Floats) -> Estimate:
    """Relative change of momentum at hit k where it is not held, and its standard error."""

    def change(states: Sequence[ContactState]) -> Floats:
        out: Floats = mass @ (states[0].after - states[0].before)
        return out

    value, cov = fit.propagate([k], change)
    total = float(np.hypot(*(mass @ fit.contact_state(k).before)))
    if total < 1e-6:
        return Estimate()
    return Estimate(float(np.hypot(*value)) / total, float(np.sqrt(np.trace(cov))) / total)


def _square(value: Estimate) -> float:
    """Square of a value in its standard errors; 0 where it is not known."""
    return (value.value / value.stderr) ** 2 if value.value and value.stderr else 0.0


def _birge(ratio: float, free: int) -> float:
    """Factor on variances by the mean square of so many misses in their errors; 1 if it is chance.

    See Birge, 1932, Phys. Rev. 40, 207.
    """
    return ratio if ratio > 1 + np.sqrt(2 / free) else 1.0


def pooled(values: Floats, cov: Floats) -> Estimate:
    """Weighted mean of correlated values; its error grows with their scatter."""
    if not len(values):
        return Estimate()
    weights = np.linalg.solve(cov, np.ones(len(values)))
    mean = float(weights @ values / weights.sum())
    variance = 1 / float(weights.sum())
    if len(values) > 1:
        off, free = values - mean, len(values) - 1
        variance *= _birge(float(off @ np.linalg.solve(cov, off)) / free, free)
    return Estimate(mean, float(np.sqrt(variance)))
