"""How the ice slows the stones: friction from every glide, and pooled."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from curlshot.data.estimates import Estimate, Friction, Glide
from curlshot.data.sheet import GRAVITY, curling_size
from curlshot.physics.filter.slowing import (
    FORM_SD,
    SHARE,
    V_C,
    change_by,
    more,
    power_at,
    power_prior,
    speed_left,
)
from curlshot.physics.local_fit.free_glides import are_free, is_pushed
from curlshot.physics.local_fit.solution import ACCELERATION, POWER, Deceleration, LocalFit
from curlshot.physics.local_fit.traces import PLACE_REACH, Trace
from curlshot.physics.statistics.random_effects import random_effects, weighted_mean

Floats = NDArray[np.float64]

USUAL, ANY = Estimate(0.103, 0.04), Estimate(0.1, 0.1)
"""Deceleration of curling stones on ice (μ of 0.006 to 0.016 was measured by Li et al., 2022,
Lubricants 10, 265) and of anything that glides, m/s²: only used where the glides tell less."""

LEAST_SPREAD = 0.01
"""Least spread of decelerations from glide to glide, m/s²: no ice law is exactly constant."""

TURNING = 0.02
"""Acceleration across the motion, m/s², by which ice turns a curling stone to either side: twice
FCV1's 0.0082 times the power 0.2 of the speed (Uehara and Ito, 2021), for a hit sets the spins, and
with them the side, so that all hits of a kind would be drawn the same way."""

EVEN = Estimate(0.0, 0.0)
"""Share of the deceleration of anything that glides that fades with the speed."""

SHARES = np.linspace(-0.2, 1.0, 61)
"""Shares of the friction at 1 m/s that may fade with the speed."""

TOLD = 3.0
"""How much more probable a power of the speed must make the glides to be told: what counts as
evidence at all (Kass and Raftery, 1995, J. Am. Stat. Assoc. 90, 773)."""

CLEAR = 2.0
"""Excess of the misfit of one deceleration for all glides from which they are known to differ."""

WORST = 0.02
"""Standard error of a friction beyond which a glide is said to tell nothing."""


def free(radius: float) -> Deceleration:
    """Weak prior of the decelerations of discs, for when they are to be measured."""
    share = SHARE if curling_size(radius) else EVEN
    return Deceleration(0.0, 3.0, 3.0, float(share.value or 0.0), float(share.stderr or 0.0))


@dataclass(frozen=True)
class Glides:
    """What the glides of a shot tell.

    Attributes
    ----------
    free : tuple of Glide
        Each piece that is slowed by the ice alone, long enough to tell its friction.
    friction : Friction
        Pooled over them.
    prior : Deceleration
        What to assume of a piece that is too short to tell: as all others have it, free or not.
    told : bool
        Whether there is any of them; else `prior` is what is known of any disc.
    pushed : tuple of Glide
        Pieces in which a stone is pushed, carried or led.
    """

    free: tuple[Glide, ...]
    friction: Friction
    prior: Deceleration
    told: bool
    pushed: tuple[Glide, ...]


def measure_glides(
    fit: LocalFit,
    known: Mapping[str, Trace],
    radius: float,
    changes: Mapping[str, Sequence[float]] = MappingProxyType({}),
) -> Glides:
    """Measure the friction of each glide of a fit that assumed `free` decelerations.

    Stones whose motion changes too often without a hit, at the times `changes`, tell none.
    """
    law = free(radius)
    each = list(_long_glides(fit, known, radius))
    slowed, shape = _told(fit, each, law)
    pooled = random_effects(*slowed.at_1_m_per_s(shape.share, shape.sd))
    spread = pooled.spread if pooled.excess > CLEAR else 0.0
    usual = USUAL if curling_size(radius) else ANY
    mean, sd = float(usual.value or 0.0), float(usual.stderr or 0.0)
    if pooled.mean.value is not None and pooled.mean.stderr is not None:
        measured, error = pooled.mean.value, max(pooled.mean.stderr, 1e-6)
        share = sd**2 / (sd**2 + error**2)
        mean, sd = mean + share * (measured - mean), sd * error / float(np.hypot(sd, error))
    spread = float(np.sqrt(max(spread, LEAST_SPREAD) ** 2 + sd**2))
    across = float(np.hypot(spread, TURNING)) if curling_size(radius) else spread
    pushed = {one.rank: one.glide for one in each if one.pushed}
    of_ice = are_free(fit.pieces, pushed, changes)
    alone = [one for one in each if of_ice[one.rank]]
    own = (slowed, shape) if len(alone) == len(each) else _told(fit, alone, law)
    return Glides(
        tuple(one.glide for one in alone),
        _friction(alone, *own, law),
        replace(law, mean=mean, along=spread, across=across, share=shape.share, sd_share=shape.sd),
        bool(each),
        tuple(pushed.values()),
    )


@dataclass(frozen=True)
class _MeasuredGlide:
    """A glide with its deceleration half-way, m/s², at the speed there, m/s.

    ``by_fit`` are the derivatives of the deceleration by the unknowns of the fit, ``bent`` is its
    error from the error that places share, `pushed` whether it is no free glide.
    """

    glide: Glide
    rank: int
    speed: float
    value: float
    by_fit: Floats
    bent: float
    pushed: bool


def _long_glides(
    fit: LocalFit, known: Mapping[str, Trace], radius: float
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
        pushed = is_pushed(slowing, aside, GRAVITY * sd, sd_aside)
        yield _MeasuredGlide(glide, i, speed, slowing, by_fit, bent, pushed)


@dataclass(frozen=True)
class _Slowed:
    """Decelerations of all glides half-way, m/s², and their covariance.

    ``rise`` is how much more there is, at the speeds there, of the part that fades.
    """

    values: Floats
    cov: Floats
    rise: Floats

    def at_1_m_per_s(self, share: float, sd_share: float) -> tuple[Floats, Floats]:
        """Decelerations at 1 m/s and their covariance, if one share of all of them fades."""
        scale = 1 / (1 + share * self.rise)
        values = scale * self.values
        unsure = sd_share * values * scale * self.rise
        return values, np.outer(scale, scale) * self.cov + np.outer(unsure, unsure)


def _slowed(fit: LocalFit, each: Sequence[_MeasuredGlide]) -> _Slowed:
    """Put the decelerations of all glides together."""
    rows = np.array([one.by_fit for one in each]).reshape(len(each), len(fit.theta))
    cov = rows @ fit.cov @ rows.T + np.diag([one.bent**2 for one in each])
    return _Slowed(np.array([one.value for one in each]), cov, more([one.speed for one in each]))


def _told(
    fit: LocalFit, each: Sequence[_MeasuredGlide], law: Deceleration
) -> tuple[_Slowed, _Shape]:
    """Put glides together, and tell from them how the friction falls."""
    slowed = _slowed(fit, each)
    return slowed, _shape(fit, each, slowed, law)


def _acceleration(fit: LocalFit, rank: int, t: float, way: Floats) -> tuple[float, Floats]:
    """Acceleration of a piece in a direction, at a time, and its derivatives by `fit.theta`."""
    own, x, power = fit.unknowns(rank), fit.state(rank), fit.power(rank)
    slower = -float(np.log(speed_left(x, t - fit.origins[rank], power)))
    slope = np.zeros(len(fit.theta))
    slope[own[ACCELERATION]] = change_by(t - fit.origins[rank], x, power, way)
    value = float(slope @ fit.theta)
    slope[own[POWER]] = value * slower
    return value, slope


@dataclass(frozen=True)
class _Shape:
    """Share of the friction at 1 m/s that fades with the speed, as glides tell it.

    ``share`` ± ``sd``, and the Bayes factor of such a law against a friction that is the same at
    all speeds.
    """

    share: float
    sd: float
    factor: float


def _shape(
    fit: LocalFit, each: Sequence[_MeasuredGlide], slowed: _Slowed, law: Deceleration
) -> _Shape:
    """Tell how a friction falls, from each glide's course and from how glides differ.

    The Bayes factor is the ratio of the prior to the posterior density at a share of 0 (Dickey,
    1971, Annals of Mathematical Statistics 42, 204).
    """
    if not law.sd_share:
        return _Shape(law.share, 0.0, 0.0)
    misfit = ((SHARES - law.share) / law.sd_share) ** 2
    before = _density(misfit)
    for one in each:
        # What is known beforehand is in the power of each piece, and counts but once.
        power = fit.unknowns(one.rank)[POWER]
        start = float(np.hypot(*fit.state(one.rank)[:, 1]))
        usual, sd = power_prior(start, law.share, law.sd_share)
        told = 1 / fit.cov[power, power] - sd**-2
        if told > 0:
            alone = usual + (fit.theta[power] - usual) / (fit.cov[power, power] * told)
            misfit += (alone - power_at(one.speed, SHARES)) ** 2 / (1 / told + FORM_SD**2)
    if each:
        steep = [slowed.at_1_m_per_s(share, 0.0) for share in SHARES.tolist()]
        # Where no share makes them agree, what is left is no evidence for any.
        spread = min(random_effects(*steep[k]).spread for k in range(0, len(steep), 10))
        least = max(LEAST_SPREAD, spread) ** 2
        misfit += [weighted_mean(*values, least)[2] for values in steep]
    after = _density(misfit)
    share = float(SHARES @ after)
    sd = float(np.sqrt((SHARES - share) ** 2 @ after))
    even = int(np.argmin(np.abs(SHARES)))
    return _Shape(share, sd, float(before[even] / max(after[even], 1e-30)))


def _density(misfit: Floats) -> Floats:
    weights = np.exp(-0.5 * (misfit - misfit.min()))
    return np.asarray(weights / weights.sum())


def _acceleration_error(sd_place: Floats, speed: float, duration: float) -> Floats:
    """Error of a deceleration on either axis, m/s², from the error that places share.

    Places whose error is s at one end, the other or between bend the path in time like an
    acceleration of which s is the sagitta, a T² / 8. Over less than `PLACE_REACH` either side
    of the middle the error is much the same throughout and bends less.
    """
    share = min(1.0, speed * duration / (2 * PLACE_REACH))
    return np.asarray(8 * share * np.median(sd_place, axis=0) / duration**2)


def _friction(
    each: Sequence[_MeasuredGlide], slowed: _Slowed, shape: _Shape, law: Deceleration
) -> Friction:
    """Friction that the glides show: the same at all speeds unless they tell that it falls.

    If it does it is that at 1 m/s, with a law of `curlshot.physics.ice.Fit`'s form with FCV1's v_c.
    If not, what it would be at 1 m/s is in the error.
    """
    flat = slowed.at_1_m_per_s(0.0, 0.0)
    even = random_effects(*flat).mean
    if even.value is None or even.stderr is None:
        return Friction()
    if not law.sd_share:
        return Friction(even.value / GRAVITY, even.stderr / GRAVITY)
    values, cov = slowed.at_1_m_per_s(shape.share, shape.sd)
    pooled = random_effects(values, cov)
    # How far the form leads astray is no error that glides tell of: it has no say in the weights.
    lean = weighted_mean(values * _by_form(each, shape.share), cov, pooled.spread**2)[0]
    value = float(pooled.mean.value or 0.0) / GRAVITY
    stderr = float(np.hypot(pooled.mean.stderr or 0.0, lean)) / GRAVITY
    if shape.factor < TOLD:
        usual = even.value / GRAVITY
        return Friction(usual, float(np.hypot(stderr, usual - value)))
    if shape.share <= 0 or value <= 0:
        return Friction(value, stderr)
    a = shape.share * value * (1 + V_C)
    return Friction(value, stderr, "fit", a, V_C, value - a / (1 + V_C))


def _by_form(each: Sequence[_MeasuredGlide], share: float) -> Floats:
    """How much larger frictions at 1 m/s are if the law is as good a power of the speed."""
    speeds = np.array([one.speed for one in each])
    by_power = speeds ** power_at(speeds, share) * (1 + share * more(speeds))
    return np.asarray(by_power - 1)
