"""How the ice slows the stones: friction from every glide, and pooled."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from data.results import Estimate, Friction, Glide
from data.sheet import GRAVITY, curling_size
from physics.ice import FCV1
from physics.random_effects import random_effects
from physics.shot_fit import Deceleration, ShotFit
from physics.slowing import speed_left
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

STEEPEST = 0.7
"""Power of the speed beyond which FCV1's form, of two positive parts, follows no more."""

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
    each = list(_each(fit, known, radius))
    power, sd_power = _power(fit, [one.rank for one in each], law)
    pooled = random_effects(*_at_one(fit, each, power, sd_power))
    friction = _friction(pooled.mean, power, [one.speed for one in each])
    spread = pooled.spread if pooled.excess > CLEAR else 0.0
    usual = USUAL if curling_size(radius) else ANY
    mean, sd = float(usual.value or 0.0), float(usual.stderr or 0.0)
    if friction.value is not None and friction.stderr is not None:
        measured, error = friction.value * GRAVITY, max(friction.stderr * GRAVITY, 1e-6)
        share = sd**2 / (sd**2 + error**2)
        mean, sd = mean + share * (measured - mean), sd * error / float(np.hypot(sd, error))
    spread = float(np.sqrt(max(spread, LEAST_SPREAD) ** 2 + sd**2))
    return (
        tuple(one.glide for one in each),
        friction,
        replace(law, mean=mean, along=spread, across=spread, fall=power),
    )


@dataclass(frozen=True)
class _Told:
    """A glide, and the deceleration that its piece tells at its speed half-way, m/s and m/s².

    ``by_fit`` are its derivatives by the unknowns of the fit, ``bent`` is its error from what
    places share.
    """

    glide: Glide
    rank: int
    speed: float
    value: float
    by_fit: Floats
    bent: float


def _each(fit: ShotFit, known: Mapping[str, Trace], radius: float) -> Iterator[_Told]:
    """Each glide that is long enough."""
    for i, piece in enumerate(fit.pieces):
        if piece.rest or len(piece.samples) < 5:
            continue
        t = known[piece.stone].t[piece.samples]
        start, end = float(t[0]), min(float(t[-1]), fit.stop(i))
        middle = 0.5 * (start + end)
        velocity = fit.motion(i, middle)[1]
        speed = float(np.hypot(*velocity))
        if speed < radius or speed * (end - start) < radius:
            continue
        along = velocity / speed
        to_left = np.array([-along[1], along[0]])
        slowing, by_fit = _acceleration(fit, i, middle, -along)
        aside, aside_by_fit = _acceleration(fit, i, middle, to_left)
        bend = _bend(known[piece.stone].sd_place[piece.samples], speed, end - start)
        bent, bent_aside = (float(np.hypot(*(bend * way))) for way in (along, to_left))
        sd = float(np.hypot(np.sqrt(by_fit @ fit.cov @ by_fit), bent)) / GRAVITY
        sd_aside = float(np.hypot(np.sqrt(aside_by_fit @ fit.cov @ aside_by_fit), bent_aside))
        if sd > WORST:
            continue
        glide = Glide(
            piece.stone, start, end, slowing / GRAVITY, sd, aside / speed, sd_aside / speed, speed
        )
        yield _Told(glide, i, speed, slowing, by_fit, bent)


def _at_one(
    fit: ShotFit, each: Sequence[_Told], power: float, sd_power: float
) -> tuple[Floats, Floats]:
    """Decelerations at 1 m/s, with covariance: the power that leads there is that of all."""
    logs = np.log([one.speed for one in each])
    scale = np.exp(power * logs)
    values = scale * [one.value for one in each]
    rows = np.array([one.by_fit for one in each]).reshape(len(each), len(fit.theta))
    cov = rows @ fit.cov @ rows.T + np.diag([one.bent**2 for one in each])
    unsure = sd_power * values * logs
    return values, np.outer(scale, scale) * cov + np.outer(unsure, unsure)


def _acceleration(fit: ShotFit, rank: int, t: float, way: Floats) -> tuple[float, Floats]:
    """Acceleration of a piece in a direction, at a time, and its derivatives by `fit.theta`."""
    own, power = fit.unknowns(rank), fit.power(rank)
    x = fit.theta[own[:6]].reshape(2, 3)
    slower = -float(np.log(speed_left(x, t - fit.origins[rank], power)))
    slope = np.zeros(len(fit.theta))
    slope[own[[2, 5]]] = np.exp(power * slower) * way
    value = float(slope @ fit.theta)
    slope[own[6]] = value * slower
    return value, slope


def _power(fit: ShotFit, ranks: Sequence[int], law: Deceleration) -> tuple[float, float]:
    """Power of the speed that slows the stones of some pieces, and its standard error."""
    if not law.sd_fall:
        return law.fall, 0.0
    # What is known beforehand is in the power of each piece, and counts but once.
    known = law.sd_fall**-2
    at = [fit.unknowns(rank)[6] for rank in ranks]
    told = 1 / np.diag(fit.cov)[at]
    every = known + float(np.sum(np.maximum(told - known, 0.0)))
    return law.fall + float(told @ (fit.theta[at] - law.fall)) / every, every**-0.5


def _bend(sd_place: Floats, speed: float, duration: float) -> Floats:
    """Error of a deceleration on either axis, m/s², from the error that places share.

    Places whose error is s at one end, the other or between bend the path in time like an
    acceleration of which s is the sagitta, a T² / 8. Over less than `PLACE_REACH` either side
    of the middle the error is much the same throughout and bends less.
    """
    share = min(1.0, speed * duration / (2 * PLACE_REACH))
    return np.asarray(8 * share * np.median(sd_place, axis=0) / duration**2)


def _friction(deceleration: Estimate, power: float, speeds: Sequence[float]) -> Friction:
    """Friction at 1 m/s that a deceleration there shows, and a law with it.

    The law is that of `physics.ice.Fit` with FCV1's v_c: the same at 1 m/s as the power of the
    speed, and at the mean of the speeds (m/s).
    """
    if deceleration.value is None or deceleration.stderr is None:
        return Friction()
    mu, stderr = deceleration.value / GRAVITY, deceleration.stderr / GRAVITY
    steep = min(power, STEEPEST)
    if steep <= 0 or mu <= 0:
        return Friction(mu, stderr)
    v_c = FCV1().v_c
    mean = float(np.exp(np.mean(np.log(speeds))))
    if abs(mean - 1) > 1e-3:
        a = mu * (mean**-steep - 1) / (1 / (mean + v_c) - 1 / (1 + v_c))
    else:
        a = mu * steep * (1 + v_c) ** 2
    return Friction(mu, stderr, "fit", a, v_c, mu - a / (1 + v_c))
