"""How the ice slows the stones: friction from every glide, and pooled."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from data.results import Estimate, Friction, Glide
from data.sheet import GRAVITY, curling_size
from physics.filter.slowing import FALL, change_by, speed_left
from physics.ice import FCV1
from physics.local_fit.shot_fit import Deceleration, ShotFit
from physics.local_fit.traces import PLACE_REACH, Trace
from physics.statistics.random_effects import random_effects, weighted_mean

Floats = NDArray[np.float64]

USUAL, ANY = Estimate(0.103, 0.04), Estimate(0.1, 0.1)
"""Deceleration of curling stones on ice (μ of 0.006 to 0.016 was measured by Li et al., 2022,
Lubricants 10, 265) and of anything that glides, m/s²: only used where the glides tell less."""

LEAST_SPREAD = 0.01
"""Least spread of decelerations from glide to glide, m/s²: no ice law is exactly constant."""

TURNING = 0.01
"""Acceleration across the motion, m/s², by which ice turns a curling stone to either side: 0.0082
times the power 0.2 of the speed (FCV1; Uehara and Ito, 2021)."""

EVEN = Estimate(0.0, 0.0)
"""Power of the speed with which the deceleration of anything that glides falls."""

STEEPEST = 0.7
"""Power of the speed beyond which FCV1's form, of two positive parts, follows no more."""

TOLD = 3.0
"""How much more probable a power of the speed must make the glides to be told: what counts as
evidence at all (Kass and Raftery, 1995, J. Am. Stat. Assoc. 90, 773)."""

CLEAR = 2.0
"""Excess of the misfit of one deceleration for all glides from which they are known to differ."""

WORST = 0.02
"""Standard error of a friction beyond which a glide is said to tell nothing."""


def free(radius: float) -> Deceleration:
    """Weak prior of the decelerations of discs, for when they are to be measured."""
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
    each = list(_long_glides(fit, known, radius))
    power, sd_power = _power(fit, [one.rank for one in each], law)
    pooled = random_effects(*_at_1_m_per_s(fit, each, power, sd_power))
    friction = _friction(fit, each, law, power, sd_power)
    spread = pooled.spread if pooled.excess > CLEAR else 0.0
    usual = USUAL if curling_size(radius) else ANY
    mean, sd = float(usual.value or 0.0), float(usual.stderr or 0.0)
    if pooled.mean.value is not None and pooled.mean.stderr is not None:
        measured, error = pooled.mean.value, max(pooled.mean.stderr, 1e-6)
        share = sd**2 / (sd**2 + error**2)
        mean, sd = mean + share * (measured - mean), sd * error / float(np.hypot(sd, error))
    spread = float(np.sqrt(max(spread, LEAST_SPREAD) ** 2 + sd**2))
    across = float(np.hypot(spread, TURNING)) if curling_size(radius) else spread
    return (
        tuple(one.glide for one in each),
        friction,
        replace(law, mean=mean, along=spread, across=across, fall=power),
    )


@dataclass(frozen=True)
class _MeasuredGlide:
    """A glide with its deceleration half-way, m/s², at the speed there, m/s.

    ``by_fit`` are the derivatives of the deceleration by the unknowns of the fit, ``bent`` is its
    error from the error that places share.
    """

    glide: Glide
    rank: int
    speed: float
    value: float
    by_fit: Floats
    bent: float


def _long_glides(
    fit: ShotFit, known: Mapping[str, Trace], radius: float
) -> Iterator[_MeasuredGlide]:
    """Measure each glide that is long enough."""
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
        bend = _acceleration_error(known[piece.stone].sd_place[piece.samples], speed, end - start)
        bent, bent_aside = (float(np.hypot(*(bend * way))) for way in (along, to_left))
        sd = float(np.hypot(np.sqrt(by_fit @ fit.cov @ by_fit), bent)) / GRAVITY
        sd_aside = float(np.hypot(np.sqrt(aside_by_fit @ fit.cov @ aside_by_fit), bent_aside))
        if sd > WORST:
            continue
        glide = Glide(
            piece.stone, start, end, slowing / GRAVITY, sd, aside / speed, sd_aside / speed, speed
        )
        yield _MeasuredGlide(glide, i, speed, slowing, by_fit, bent)


def _at_1_m_per_s(
    fit: ShotFit, each: Sequence[_MeasuredGlide], power: float, sd_power: float
) -> tuple[Floats, Floats]:
    """Decelerations at 1 m/s and their covariance, by one power of the speed for all."""
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
    slope[own[[2, 5]]] = change_by(t - fit.origins[rank], x, power, way)
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


def _acceleration_error(sd_place: Floats, speed: float, duration: float) -> Floats:
    """Error of a deceleration on either axis, m/s², from the error that places share.

    Places whose error is s at one end, the other or between bend the path in time like an
    acceleration of which s is the sagitta, a T² / 8. Over less than `PLACE_REACH` either side
    of the middle the error is much the same throughout and bends less.
    """
    share = min(1.0, speed * duration / (2 * PLACE_REACH))
    return np.asarray(8 * share * np.median(sd_place, axis=0) / duration**2)


def _friction(
    fit: ShotFit, each: Sequence[_MeasuredGlide], law: Deceleration, power: float, sd_power: float
) -> Friction:
    """Friction that the glides show: the same at all speeds unless they tell that it falls.

    If it does it is that at 1 m/s, with a law of `physics.ice.Fit`'s form with FCV1's v_c: the
    same there and at the mean of the speeds. If not, what it would be at 1 m/s is in the error.
    """
    flat = _at_1_m_per_s(fit, each, 0.0, 0.0)
    even = random_effects(*flat).mean
    if even.value is None or even.stderr is None:
        return Friction()
    if not law.sd_fall:
        return Friction(even.value / GRAVITY, even.stderr / GRAVITY)
    speeds = np.array([one.speed for one in each])
    values, cov = _at_1_m_per_s(fit, each, power, sd_power)
    form = _law_difference(speeds, power)
    steep = values * (1 + form), cov
    pooled = random_effects(*steep)
    # How far the form leads astray is no error that glides tell of: it has no say in the weights.
    lean = weighted_mean(values * form, cov, pooled.spread**2)[0]
    value = float(pooled.mean.value or 0.0) / GRAVITY
    stderr = float(np.hypot(pooled.mean.stderr or 0.0, lean)) / GRAVITY
    if _bayes_factor(flat, steep, Estimate(power, sd_power), law) < TOLD:
        usual = even.value / GRAVITY
        return Friction(usual, float(np.hypot(stderr, usual - value)))
    if power <= 0 or value <= 0:
        return Friction(value, stderr)
    v_c, mean = FCV1().v_c, float(np.exp(np.mean(np.log(speeds))))
    fall = min(power, STEEPEST)
    if abs(mean - 1) > 1e-3:
        there = value / (1 + float(_law_difference(np.array([mean]), fall)[0])) * mean**-fall
        a = (there - value) / (1 / (mean + v_c) - 1 / (1 + v_c))
    else:
        a = value * fall * (1 + v_c) ** 2
    return Friction(value, stderr, "fit", a, v_c, value - a / (1 + v_c))


def _bayes_factor(
    even: tuple[Floats, Floats], bent: tuple[Floats, Floats], power: Estimate, law: Deceleration
) -> float:
    """Bayes factor of a deceleration that falls as a power of the speed against a constant one.

    Within glides it is the ratio of the prior to the posterior density at the power 0 (Dickey,
    1971, Annals of Mathematical Statistics 42, 204); between them it follows from how well the
    decelerations agree without and with the power, `even` and `bent`.
    """
    value, error = float(power.value or 0.0), float(power.stderr or law.sd_fall)
    each = (value / error) ** 2 - (law.fall / law.sd_fall) ** 2 + 2 * np.log(error / law.sd_fall)
    # Where neither makes them agree, what both leave is no evidence for either.
    spread = max(LEAST_SPREAD, min(random_effects(*values).spread for values in (even, bent)))
    misfits = [weighted_mean(*values, spread**2)[2] for values in (even, bent)]
    return float(np.exp(np.clip(0.5 * (each + misfits[0] - misfits[1]), -50.0, 50.0)))


def _law_difference(speeds: Floats, power: float) -> Floats:
    """Relative correction of a friction at 1 m/s that a power law gave, and its standard error.

    FCV1's law and the power law with the same slope at a speed differ at 1 m/s; the truth is taken
    to lie half-way, give or take that half.
    """
    v_c = FCV1().v_c
    falling = np.minimum(power * (speeds + v_c) ** 2 / speeds, speeds + v_c)
    by_fcv1 = 1 + falling * (1 / (1 + v_c) - 1 / (speeds + v_c))
    return np.asarray(0.5 * (by_fcv1 / speeds**power - 1))
