"""Restitution and friction from tracks, each with a standard error.

Everything comes from fits to places on either side of a hit and never across it; nothing is
differentiated twice. See `physics.fit` for the model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from data.errors import InputError
from data.results import Collision, Estimate, Friction, Glide, Joint, MeasuredState
from data.sheet import STONE
from physics.contacts import Contact, cut_all
from physics.fit import fit_shot
from physics.glides import FREE, measure_glides
from physics.global_fit import GlobalFit
from physics.law_choice import fit_with_chosen_laws
from physics.residuals import huber_weights
from physics.segments import Piece
from physics.shot_fit import Encounter, Meeting, ShotFit
from physics.shot_model import ice
from physics.spins import spins_at, stone_friction
from physics.traces import Trace, traces
from physics.watched import loose_priors, watch

Floats = NDArray[np.float64]

UNEVEN, BESIDE = 0.025, 1.0
"""Where decelerations differ by more than UNEVEN (m/s²) from glide to glide, no glide is taken
to be even either, and velocities at a hit come from BESIDE seconds on either side of it."""

POOR_FIT = 30.0
"""Factor on the variance of sightings from which a simulated shot is not the one seen."""

LAWS = ("restitution", "friction", "stone_friction")
"""Unknowns of a shot that are not of one stone alone."""

WORST = 0.2
"""Standard error of a restitution beyond which a hit is said to tell nothing."""


@dataclass(frozen=True)
class Estimates:
    """What a table of sightings says about the physics of the shot.

    Attributes
    ----------
    restitution : Estimate
        Pooled over all hits.
    friction : Friction
        Pooled over all glides.
    collisions : tuple of Collision
        In order of time.
    glides : tuple of Glide
        In order of stone and time.
    warnings : tuple of str
        What could not be told and why; what does not agree.
    local : Estimate
        Restitution from either side of the hits alone, pooled.
    whole : GlobalFit or None
        The whole shot fitted through the simulator, where its stones move as it knows it.
    """

    restitution: Estimate = field(default_factory=Estimate)
    friction: Friction = field(default_factory=Friction)
    collisions: tuple[Collision, ...] = ()
    glides: tuple[Glide, ...] = ()
    warnings: tuple[str, ...] = ()
    local: Estimate = field(default_factory=Estimate)
    whole: GlobalFit | None = field(default=None, compare=False)

    @property
    def laws(self) -> Joint | None:
        """Restitution and frictions as the whole shot tells them, with their covariance."""
        return None if self.whole is None else self.whole.joint(LAWS)


def estimate(
    sightings: pd.DataFrame,
    contacts: Sequence[Contact],
    *,
    radius: float,
    masses: Mapping[str, float] | None = None,
    friction_expected: bool = True,
    inertia: float = STONE.inertia,
) -> Estimates:
    """Estimate restitution, friction and the state of the stones at each hit.

    Parameters
    ----------
    sightings : DataFrame
        `data.tracks.SIGHTING_COLUMNS`.
    contacts : sequence of Contact
        The hits, as `physics.contacts.find_contacts` gives them.
    radius : float
        Of the discs, m.
    masses : mapping, optional
        Stone to mass in any unit; equal where absent.
    friction_expected : bool
        Whether to warn when no glide gives a friction.
    inertia : float
        k in I = k m R²; decides whether a contact can have slid throughout.
    """
    known = traces(sightings)
    meetings = [
        Meeting(c.t, c.stones, max(_gap(known[stone], c.t) for stone in c.stones)) for c in contacts
    ]
    pieces, _ = cut_all(known, meetings, radius)
    idle = [piece for piece in pieces if piece.rest and _alone(piece)]
    still = [_scatter(known[piece.stone], piece) for piece in idle]
    pieces = [piece for piece in pieces if not (piece.rest and _alone(piece))]
    warnings: list[str] = []
    if not pieces:
        return Estimates(warnings=("no stone moves: neither restitution nor friction",))
    loose = fit_shot(known, pieces, meetings, radius, masses=masses, still=still, deceleration=FREE)
    glides, friction, prior = measure_glides(loose, known, radius)
    if friction.value is None and friction_expected:
        warnings.append("friction: no stone glides freely for long enough to tell it")
    value, stderr = friction.value, friction.stderr
    each = [glide.friction for glide in glides if glide.friction is not None]
    if value is not None and stderr is not None and value + 2 * stderr < 0:
        warnings.append(
            f"friction: the stones gain speed (μ = {value:.3f} ± {stderr:.3f}), so these are no"
            " free glides on level ice; not reported"
        )
        friction = Friction()
    elif value is not None and len(each) > 1 and prior.along > max(UNEVEN, 0.3 * prior.mean):
        warnings.append(
            f"friction differs from glide to glide ({min(each):.4f} to {max(each):.4f}):"
            " it depends on speed or place, the value is a mean"
        )
    if not meetings:
        warnings.append("restitution: no hit seen")
        return Estimates(Estimate(), friction, (), glides, tuple(warnings))
    if prior.along > UNEVEN:
        pieces = [_near(piece, known[piece.stone], meetings) for piece in pieces]
    joint = fit_shot(
        known, pieces, meetings, radius, masses=masses, still=still, deceleration=prior
    )
    apart = fit_shot(
        known,
        pieces,
        meetings,
        radius,
        masses=masses,
        still=still,
        deceleration=prior,
        momentum=False,
    )
    values, cov = joint.propagate(range(len(meetings)), _restitutions)
    notes = [_why_not(joint, k, known, values[k], cov[k, k]) for k in range(len(meetings))]
    collisions = tuple(
        _collision(joint, apart, k, known, masses or {}, radius, inertia, values, cov, notes[k])
        for k in range(len(meetings))
    )
    for hit in collisions:
        name = f"hit of {hit.stones[0]} and {hit.stones[1]} at {hit.t:.2f} s"
        if hit.note:
            warnings.append(f"{name}: {hit.note}")
        if (
            hit.momentum_residual is not None
            and hit.stderr_momentum is not None
            and hit.momentum_residual > max(0.05, 3 * hit.stderr_momentum)
        ):
            warnings.append(
                f"{name}: momentum changes by {100 * hit.momentum_residual:.0f} %"
                f" ± {100 * hit.stderr_momentum:.0f} %: scale, masses or tracks are off"
            )
    warnings += _distances(joint, radius)
    usable = [k for k, note in enumerate(notes) if note is None]
    local = _pooled(values[usable], cov[np.ix_(usable, usable)])
    whole, why_not = _whole(known, joint, radius, masses or {}, inertia, local)
    warnings += why_not
    restitution = local if whole is None or not whole.told("restitution") else whole["restitution"]
    if local.value is None:
        restitution = local
    if whole is not None and friction.value is not None and whole.told("friction"):
        friction = _friction(whole)
        warnings = [text for text in warnings if not text.startswith("friction differs")]
    return Estimates(restitution, friction, collisions, glides, tuple(warnings), local, whole)


def _friction(whole: GlobalFit) -> Friction:
    """Friction of the ice at 1 m/s with the law that the whole shot was fitted with."""
    mu = whole["friction"]
    if "slope" in whole.fixed:
        return Friction(mu.value, mu.stderr)
    law = ice(whole.state())
    return Friction(mu.value, mu.stderr, "fit", law.a, law.v_c, law.b)


def _whole(
    known: Mapping[str, Trace],
    fit: ShotFit,
    radius: float,
    masses: Mapping[str, float],
    inertia: float,
    local: Estimate,
) -> tuple[GlobalFit | None, list[str]]:
    """Fit the whole shot through the simulator, or say why what it gives is not used."""
    watched = watch(known, fit, radius, priors=loose_priors(radius), masses=masses, inertia=inertia)
    if watched is None or not watched.hits:
        return None, []
    try:
        whole = fit_with_chosen_laws([watched])
    except InputError as error:
        return None, [f"whole shot: cannot be simulated ({error}); values beside the hits used"]
    if not whole.settled or not whole.hits_as_seen:
        return None, ["whole shot: the simulator does not follow it; values beside the hits used"]
    e = whole["restitution"]
    if whole.inflation > POOR_FIT:
        return None, [
            "whole shot: the simulated paths differ from the tracks by more than their errors"
            f" (variance × {whole.inflation:.0f}); values beside the hits used"
        ]
    if None in (e.value, e.stderr, local.value, local.stderr):
        return whole, []
    off = abs(float(e.value or 0) - float(local.value or 0))
    if off > 3 * float(np.hypot(e.stderr or 0, local.stderr or 0)):
        return None, [
            f"restitution: {local.value:.3f} ± {local.stderr:.3f} beside the hits,"
            f" {e.value:.3f} ± {e.stderr:.3f} from the whole shot, which disagree; the first used"
        ]
    return whole, []


def _alone(piece: Piece) -> bool:
    return piece.opens is None and piece.closes is None


def _near(piece: Piece, trace: Trace, meetings: Sequence[Meeting]) -> Piece:
    """Leave out of a moving piece what is far from the hits that bound it."""
    hits = [meetings[k].t for k in (piece.opens, piece.closes) if k is not None]
    if piece.rest or not hits:
        return piece
    t = trace.t[piece.samples]
    beside = np.min([np.abs(t - hit) for hit in hits], axis=0) < BESIDE
    return replace(piece, samples=piece.samples[beside])


def _scatter(trace: Trace, piece: Piece) -> Floats:
    """Normalised residuals of a stone at rest."""
    xy = trace.xy[piece.samples]
    out: Floats = (xy - np.median(xy, axis=0)) / trace.sd[piece.samples]
    return out * huber_weights(out)


def _gap(trace: Trace, time: float) -> float:
    """Time between the sightings either side of `time`, at least the usual step."""
    if len(trace.t) < 2:
        return trace.step
    k = int(np.clip(np.searchsorted(trace.t, time), 1, len(trace.t) - 1))
    return max(trace.step, float(trace.t[k] - trace.t[k - 1]))


def _restitutions(states: Sequence[Encounter]) -> Floats:
    out = []
    for state in states:
        closing = (state.before[0] - state.before[1]) @ state.normal
        leaving = (state.after[1] - state.after[0]) @ state.normal
        out.append(leaving / closing)
    return np.array(out)


def _why_not(
    fit: ShotFit, k: int, known: Mapping[str, Trace], value: float, variance: float
) -> str | None:
    """Why a hit cannot tell its restitution; None where it can."""
    stderr = float(np.sqrt(variance))
    if np.isfinite(value) and stderr < WORST:
        return None
    for stone in fit.meetings[k].stones:
        for rank, when in zip(fit.sides[k, stone], ("before", "after"), strict=True):
            seen = len(fit.pieces[rank].samples)
            if seen < 4:
                return f"restitution unknown: {stone} is seen {seen} times {when} it"
    return f"restitution unknown: its standard error would be {stderr:.2g}"


def _collision(
    joint: ShotFit,
    apart: ShotFit,
    k: int,
    known: Mapping[str, Trace],
    masses: Mapping[str, float],
    radius: float,
    inertia: float,
    values: Floats,
    cov: Floats,
    note: str | None,
) -> Collision:
    first, second = joint.meetings[k].stones
    state = joint.encounter(k)
    mass = np.array([masses.get(first, 1.0), masses.get(second, 1.0)])
    spins = spins_at(joint, k, known, mass)
    before, after = _states(joint, k, known, spins)
    energy = [float(mass @ np.sum(speeds**2, axis=1)) for speeds in (state.before, state.after)]
    residual, stderr_residual = _momentum(apart, k, mass)
    rubbing = stone_friction(joint, k, spins, radius, inertia) if note is None else None
    at = 6 * len(joint.pieces) + k
    nx, ny = (float(value) for value in state.normal)
    return Collision(
        t=state.t,
        stderr_t=float(np.sqrt(joint.cov[at, at])),
        stones=(first, second),
        normal=(nx, ny),
        restitution=float(values[k]) if note is None else None,
        stderr=float(np.sqrt(cov[k, k])) if note is None else None,
        before=before,
        after=after,
        momentum_residual=residual,
        stderr_momentum=stderr_residual,
        energy_lost=1 - energy[1] / energy[0] if energy[0] > 0 else None,
        stone_friction=None if rubbing is None else rubbing[0],
        stderr_stone_friction=None if rubbing is None else rubbing[1],
        note=note,
    )


def _states(
    fit: ShotFit, k: int, known: Mapping[str, Trace], spins: Sequence[tuple[Estimate, Estimate]]
) -> tuple[dict[str, MeasuredState], dict[str, MeasuredState]]:
    """States of the two stones before and after hit k, by stone, with their errors."""

    def flat(states: Sequence[Encounter]) -> Floats:
        state = states[0]
        return np.array([state.places, state.before, state.after]).ravel()

    values, cov = fit.propagate([k], flat)
    xy, *speeds = values.reshape(3, 2, 2)
    spread, *errors = np.sqrt(np.diag(cov)).reshape(3, 2, 2)
    out: tuple[dict[str, MeasuredState], dict[str, MeasuredState]] = ({}, {})
    for i, stone in enumerate(fit.meetings[k].stones):
        trace = known[stone]
        # What all places near each other share is no scatter that the fit could see.
        shared = float(trace.sd_place[np.argmin(np.abs(trace.t - fit.time(k)))])
        place = (*xy[i].tolist(), *np.hypot(spread[i], shared).tolist())
        for when, side in enumerate(out):
            side[stone] = _state(place, speeds[when][i], errors[when][i], spins[i][when])
    return out


def _state(
    place: tuple[float, float, float, float], speed: Floats, sd: Floats, spin: Estimate
) -> MeasuredState:
    (x, y, sd_x, sd_y), (vx, vy), (sd_vx, sd_vy) = place, speed.tolist(), sd.tolist()
    return MeasuredState(x, y, vx, vy, spin.value, sd_x, sd_y, sd_vx, sd_vy, spin.stderr)


def _momentum(fit: ShotFit, k: int, mass: Floats) -> tuple[float | None, float | None]:
    """Relative change of momentum at hit k where it is not held, and its standard error."""

    def change(states: Sequence[Encounter]) -> Floats:
        out: Floats = mass @ (states[0].after - states[0].before)
        return out

    value, cov = fit.propagate([k], change)
    total = float(np.hypot(*(mass @ fit.encounter(k).before)))
    if total < 1e-6:
        return None, None
    return float(np.hypot(*value)) / total, float(np.sqrt(np.trace(cov))) / total


def _pooled(values: Floats, cov: Floats) -> Estimate:
    """Weighted mean of correlated values; its error grows with their scatter (Birge ratio)."""
    if not len(values):
        return Estimate()
    weights = np.linalg.solve(cov, np.ones(len(values)))
    mean = float(weights @ values / weights.sum())
    variance = 1 / float(weights.sum())
    if len(values) > 1:
        off = values - mean
        variance *= max(1.0, float(off @ np.linalg.solve(cov, off)) / (len(values) - 1))
    return Estimate(mean, float(np.sqrt(variance)))


def _distances(fit: ShotFit, radius: float) -> list[str]:
    """Say so where hits happen at another distance than two radii."""

    def ratios(states: Sequence[Encounter]) -> Floats:
        return np.array([np.hypot(*(s.places[1] - s.places[0])) / (2 * radius) for s in states])

    values, cov = fit.propagate(range(len(fit.meetings)), ratios)
    mean = _pooled(values, cov)
    if mean.value is None or mean.stderr is None:
        return []
    if abs(mean.value - 1) < max(0.02, 2 * mean.stderr):
        return []
    return [
        f"discs meet at {mean.value * 2 * radius:.4g} m where two radii are {2 * radius:.4g} m:"
        " the scale or the radius is off"
    ]
