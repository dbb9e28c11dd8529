"""Spins beside a hit, and the friction between the stones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.data.results import Estimate
from curlshot.data.sheet import STONE
from curlshot.physics.filter.rate_filter import filtered, shared_response
from curlshot.physics.filter.stretch import Model, Stretch
from curlshot.physics.local_fit.noise import Noise
from curlshot.physics.local_fit.solution import ContactState, LocalFit
from curlshot.physics.local_fit.traces import Trace

Floats = NDArray[np.float64]

POOR = 0.3
"""Standard error of a spin, rad/s, from which the other stone's helps to tell it."""


def spins_at(
    fit: LocalFit,
    k: int,
    known: Mapping[str, Trace],
    noise: Mapping[str, Noise],
    mass: Floats,
) -> list[tuple[Estimate, Estimate]]:
    """Spins before and after hit k, rad/s, of its first and its second stone.

    A hit changes the spins of both by the same impulse at the same lever, so a spin that is
    hardly seen (two hits in quick succession) can be had from the change of the other's.

    Parameters
    ----------
    fit : LocalFit
        Which detections belong to which side.
    k : int
        Rank of the hit.
    known, noise : mapping
        Stone to its detections, and to how they err.
    mass : (2,) array
        Masses of the two.
    """
    stones = fit.meetings[k].stones
    t = fit.time(k)
    before, after = (
        [spin_on(fit, fit.sides[k, stone][side], known, noise, t) for stone in stones]
        for side in (0, 1)
    )
    for one, other in ((0, 1), (1, 0)):
        change = _change(before[other], after[other], mass[other] / mass[one])
        after[one] = _joined(after[one], before[one], change, 1.0)
        before[one] = _joined(before[one], after[one], change, -1.0)
    return list(zip(before, after, strict=True))


def _change(before: Estimate, after: Estimate, ratio: float) -> Estimate:
    """Change of the one stone's spin that the other's implies."""
    if before.value is None or after.value is None:
        return Estimate()
    stderr = float(np.hypot(before.stderr or 0.0, after.stderr or 0.0))
    return Estimate(ratio * (after.value - before.value), ratio * stderr)


def _joined(own: Estimate, start: Estimate, change: Estimate, sign: float) -> Estimate:
    """Improve a poorly seen spin by the spin on the other side of the hit and its change."""
    if start.value is None or change.value is None:
        return own
    if own.stderr is not None and own.stderr < POOR:
        return own
    value = start.value + sign * change.value
    variance = (start.stderr or 0.0) ** 2 + (change.stderr or 0.0) ** 2
    if own.value is None or own.stderr is None:
        return Estimate(value, float(np.sqrt(variance)))
    if variance > 0.25 * own.stderr**2:
        return own
    share = variance / (variance + own.stderr**2)
    joined = share * own.value + (1 - share) * value
    return Estimate(joined, float(np.sqrt(variance * (1 - share))))


def spin_on(
    fit: LocalFit, rank: int, known: Mapping[str, Trace], noise: Mapping[str, Noise], time: float
) -> Estimate:
    """Spin on one piece at a time on it or beside it, rad/s, as the filter of tracks tells it.

    Nothing where fewer than two angles are seen; zero for a stone at rest.

    Parameters
    ----------
    fit : LocalFit
        Which detections belong to the piece.
    rank : int
        Of the piece.
    known, noise : mapping
        Stone to its detections, and to how they err.
    time : float
        s.
    """
    piece = fit.pieces[rank]
    if piece.rest:
        return Estimate(0.0, 0.0)
    trace, errs = known[piece.stone], noise[piece.stone]
    samples = piece.samples[np.isfinite(trace.theta[piece.samples])]
    if len(samples) < 2:
        return Estimate()
    t = np.union1d(trace.t[samples], time)
    row = samples[np.minimum(np.searchsorted(trace.t[samples], t), len(samples) - 1)]
    z = np.column_stack([trace.xy, trace.theta])[row]
    z[trace.t[row] != t] = np.nan
    stop, speed = fit.stop(rank), fit.speeds(rank, t)
    one, spinning = np.zeros(len(t), dtype=int), np.zeros(len(t), dtype=bool)
    stretch = Stretch(
        t, z, errs.white[row], errs.slow[row], one, t > stop, spinning, speed, Model(0.0, 1.0)
    )
    mean, spread, _ = filtered(stretch)
    at = int(np.searchsorted(t, time))
    together = shared_response(stretch, trace.rise[row])[at, 1]
    return Estimate(float(mean[at, 5]), float(np.hypot(spread[at, 5], np.linalg.norm(together))))


def stone_friction(
    fit: LocalFit,
    k: int,
    spins: Sequence[tuple[Estimate, Estimate]],
    radius: float,
) -> tuple[Estimate, str | None]:
    """Friction between the stones where they slid throughout the contact, else why it is unknown.

    The tangential impulse that stops the slip is u_t / ((1/m1 + 1/m2)(1 + 1/k)); a smaller
    one is Coulomb's limit, μ_s times the normal impulse.
    """
    first, second = spins[0][0], spins[1][0]
    if first.value is None or second.value is None:
        stone = fit.meetings[k].stones[0 if first.value is None else 1]
        return Estimate(), f"the spin of {stone} before the hit was not measured"
    turn = radius * (first.value + second.value)

    def parts(states: Sequence[ContactState]) -> Floats:
        state = states[0]
        normal = state.normal
        tangent = np.array([-normal[1], normal[0]])
        jump = (state.after[1] - state.before[1]) - (state.after[0] - state.before[0])
        slip = float((state.before[0] - state.before[1]) @ tangent) + turn
        push = float(jump @ normal)
        closing = float((state.before[0] - state.before[1]) @ normal)
        rub = float(jump @ tangent) / push
        # Both impulses as changes of relative velocity, in which the masses drop out.
        stick = slip / ((1 + 1 / STONE.inertia) * push)
        return np.array([rub, stick, closing])

    value, cov = fit.propagate([k], parts)
    rub, stick = value[0] * np.sign(value[1]), abs(value[1])
    push = value[2] if value[2] > 0 else np.inf
    sd_turn = radius * float(np.hypot(first.stderr or 0.0, second.stderr or 0.0))
    spin_sd = sd_turn / ((1 + 1 / STONE.inertia) * push)
    sd = float(np.sqrt(cov[0, 0]))
    room = stick - rub
    sd_room = float(np.sqrt(cov[0, 0] + cov[1, 1] + spin_sd**2))
    if rub < -2 * sd:
        return Estimate(), f"the tangential impulse ({rub:.3f} ± {sd:.3f}) has the wrong sign"
    if room < 2 * sd_room:
        return Estimate(), (
            "the stones may have stopped sliding on each other: the tangential impulse that"
            f" stops it is {stick:.3f}, the measured one {rub:.3f} ± {sd_room:.3f}, in units of"
            " the normal impulse"
        )
    return Estimate(max(float(rub), 0.0), sd), None
