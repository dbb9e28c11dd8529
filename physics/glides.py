"""How the ice slows the stones: friction from every glide, and pooled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from data.results import Estimate, Friction, Glide
from data.sheet import GRAVITY, curling_size
from physics.random_effects import random_effects
from physics.shot_fit import Deceleration, ShotFit
from physics.traces import PLACE_REACH, Trace

Floats = NDArray[np.float64]

USUAL, ANY = Estimate(0.103, 0.04), Estimate(0.1, 0.1)
"""Deceleration of curling stones on ice (μ of 0.006 to 0.016 was measured by Li et al., 2022,
Lubricants 10, 265) and of anything that glides, m/s²: only used where the glides tell less."""

LEAST_SPREAD = 0.01
"""Least spread of decelerations from glide to glide, m/s²: no ice law is exactly constant."""

FALL, EVEN = Estimate(0.25, 0.2), Estimate(0.0, 0.0)
"""Power of the speed with which the deceleration of curling stones falls (0 on even ice, 1/2 in
Penner's law, between in FCV1's), and that of anything that glides."""

CLEAR = 2.0
"""Excess of the misfit of one deceleration for all glides from which they are known to differ."""

WORST = 0.02
"""Standard error of a friction beyond which a glide is said to tell nothing."""


def free(radius: float) -> Deceleration:
    """Return what is assumed of the decelerations of discs when they are to be measured."""
    fall = FALL if curling_size(radius) else EVEN
    return Deceleration(0.0, 3.0, 3.0, float(fall.value or 0.0), float(fall.stderr or 0.0))


def measure_glides(
    fit: ShotFit, known: Mapping[str, Trace], radius: float
) -> tuple[tuple[Glide, ...], Friction, Deceleration]:
    """Measure the friction of each glide of a fit that assumed `free` decelerations.

    Returns
    -------
    glides : tuple of Glide
        Each piece that is long enough to tell its friction.
    friction : Friction
        Pooled over them.
    prior : Deceleration
        What to assume of a glide that is too short to tell.
    """
    law = free(radius)
    glides, values, cov = _each(fit, known, radius, law.sd_fall)
    pooled = random_effects(values, cov)
    friction = _friction(pooled.mean)
    spread = pooled.spread if pooled.excess > CLEAR else 0.0
    usual = USUAL if curling_size(radius) else ANY
    mean, sd = float(usual.value or 0.0), float(usual.stderr or 0.0)
    if friction.value is not None and friction.stderr is not None:
        measured, error = friction.value * GRAVITY, max(friction.stderr * GRAVITY, 1e-6)
        share = sd**2 / (sd**2 + error**2)
        mean, sd = mean + share * (measured - mean), sd * error / float(np.hypot(sd, error))
    spread = float(np.sqrt(max(spread, LEAST_SPREAD) ** 2 + sd**2))
    return glides, friction, replace(law, mean=mean, along=spread, across=spread)


def _each(
    fit: ShotFit, known: Mapping[str, Trace], radius: float, sd_fall: float
) -> tuple[tuple[Glide, ...], Floats, Floats]:
    """Each glide that is long enough, and all their decelerations at 1 m/s with covariance.

    What is not known of the power of the speed that slows stones is not known of all of them
    together.
    """
    glides: list[Glide] = []
    slopes: list[Floats] = []
    bends: list[float] = []
    logs: list[float] = []
    for i, piece in enumerate(fit.pieces):
        if piece.rest or len(piece.samples) < 5:
            continue
        t = known[piece.stone].t[piece.samples]
        own = slice(6 * i, 6 * i + 6)
        cov = fit.cov[own, own]
        end = min(float(t[-1]), fit.stop(i))
        speed = fit.motion(i, 0.5 * (float(t[0]) + end))[1]
        size, first = float(np.hypot(*speed)), float(np.hypot(*fit.theta[[6 * i + 1, 6 * i + 4]]))
        if size < radius or size * (end - float(t[0])) < radius:
            continue
        along = speed / size
        slowing = np.array([0.0, 0.0, -along[0], 0.0, 0.0, -along[1]])
        aside = np.array([0.0, 0.0, -along[1], 0.0, 0.0, along[0]])  # to the left
        more = (first / size) ** fit.power(i)  # half-way, than at the origin
        bend = _bend(known[piece.stone].sd_place[piece.samples], size, end - float(t[0]))
        bent, bent_aside = np.hypot(*(bend * along)), np.hypot(*(bend * along[::-1]))
        mu = more * float(slowing @ fit.theta[own]) / GRAVITY
        sd = more * float(np.hypot(np.sqrt(slowing @ cov @ slowing), bent))
        sd_aside = float(np.hypot(np.sqrt(aside @ cov @ aside), bent_aside))
        if sd / GRAVITY > WORST:
            continue
        turn = float(aside @ fit.theta[own]) / size
        glides.append(
            Glide(piece.stone, float(t[0]), end, mu, sd / GRAVITY, turn, sd_aside / size, size)
        )
        standard = first ** fit.power(i)
        bends.append(standard * bent)
        logs.append(float(np.log(size)))
        slopes.append(np.zeros(len(fit.theta)))
        slopes[-1][own] = standard * slowing
    rows = np.array(slopes).reshape(len(glides), len(fit.theta))
    values = rows @ fit.theta
    unsure = sd_fall * values * logs
    cov = rows @ fit.cov @ rows.T + np.diag(np.square(bends)) + np.outer(unsure, unsure)
    return tuple(glides), values, cov


def _bend(sd_place: Floats, speed: float, duration: float) -> Floats:
    """Error of a deceleration on either axis, m/s², from the error that places share.

    Places whose error is s at one end, the other or between bend the path in time like an
    acceleration of which s is the sagitta, a T² / 8. Over less than `PLACE_REACH` either side
    of the middle the error is much the same throughout and bends less.
    """
    share = min(1.0, speed * duration / (2 * PLACE_REACH))
    return np.asarray(8 * share * np.median(sd_place, axis=0) / duration**2)


def _friction(deceleration: Estimate) -> Friction:
    """Coefficient of friction that a deceleration, m/s², shows."""
    if deceleration.value is None or deceleration.stderr is None:
        return Friction()
    return Friction(deceleration.value / GRAVITY, deceleration.stderr / GRAVITY)
