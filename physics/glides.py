"""How the ice slows the stones: friction from every glide, and pooled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data.results import Estimate, Friction, Glide
from data.sheet import GRAVITY
from physics.shot_fit import Deceleration, ShotFit
from physics.traces import PLACE_REACH, Trace

Floats = NDArray[np.float64]

FREE = Deceleration(0.0, 3.0, 3.0)
"""What is assumed of decelerations when they are to be measured: nothing."""

USUAL = Estimate(0.1, 0.1)
"""Deceleration of what glides, m/s²: only used where the glides at hand tell less."""

LEAST_SPREAD = 0.015
"""Least spread of decelerations from glide to glide, m/s²: no ice law is exactly constant."""

WORST = 0.02
"""Standard error of a friction beyond which a glide is said to tell nothing."""


def measure_glides(
    fit: ShotFit, known: Mapping[str, Trace], radius: float
) -> tuple[tuple[Glide, ...], Friction, Deceleration]:
    """Measure the friction of each glide of a fit that assumed `FREE` decelerations.

    Returns
    -------
    glides : tuple of Glide
        Each piece that is long enough to tell its friction.
    friction : Friction
        Pooled over them.
    prior : Deceleration
        What to assume of a glide that is too short to tell.
    """
    glides, found = _each(fit, known, radius)
    friction, spread = _pooled(found)
    mean, sd = float(USUAL.value or 0.0), float(USUAL.stderr or 0.0)
    if friction.value is not None and friction.stderr is not None:
        measured, error = friction.value * GRAVITY, max(friction.stderr * GRAVITY, 1e-6)
        share = sd**2 / (sd**2 + error**2)
        mean, sd = mean + share * (measured - mean), sd * error / float(np.hypot(sd, error))
    spread = float(np.sqrt(max(spread, LEAST_SPREAD) ** 2 + sd**2))
    return glides, friction, Deceleration(mean, spread, spread)


@dataclass(frozen=True)
class _Slowing:
    """Deceleration of one glide along its path and its error, m/s²."""

    along: float
    sd: float


def _each(
    fit: ShotFit, known: Mapping[str, Trace], radius: float
) -> tuple[tuple[Glide, ...], list[_Slowing]]:
    """Friction of each piece that is long enough to tell it."""
    glides, found = [], []
    for i, piece in enumerate(fit.pieces):
        if piece.rest or len(piece.samples) < 5:
            continue
        t = known[piece.stone].t[piece.samples]
        x = fit.theta[6 * i : 6 * i + 6].reshape(2, 3)
        cov = fit.cov[6 * i : 6 * i + 6, 6 * i : 6 * i + 6]
        end = stop_time(x, fit.origins[i], float(t[-1]))
        speed = x[:, 1] + x[:, 2] * 0.5 * (float(t[0]) + end - 2 * fit.origins[i])
        size = float(np.hypot(*speed))
        if size < radius or size * (end - float(t[0])) < radius:
            continue
        along = speed / size
        slope = np.array([0.0, 0.0, -along[0], 0.0, 0.0, -along[1]])
        value = float(slope @ fit.theta[6 * i : 6 * i + 6])
        bend = _bend(known[piece.stone].sd_place[piece.samples], size, end - float(t[0]))
        sd = float(np.hypot(np.sqrt(slope @ cov @ slope), bend))
        if sd / GRAVITY > WORST:
            continue
        # Of the acceleration across the path: to its left.
        aside = np.array([0.0, 0.0, -along[1], 0.0, 0.0, along[0]])
        turn = float(aside @ fit.theta[6 * i : 6 * i + 6]) / size
        sd_turn = float(np.hypot(np.sqrt(aside @ cov @ aside), bend)) / size
        found.append(_Slowing(value, sd))
        slowed = value / GRAVITY, sd / GRAVITY
        glides.append(Glide(piece.stone, float(t[0]), end, *slowed, turn, sd_turn, size))
    return tuple(glides), found


def _bend(sd_place: Floats, speed: float, duration: float) -> float:
    """Error of a deceleration, m/s², from the error that places share.

    Places whose error is s at one end, the other or between bend the path in time like an
    acceleration of which s is the sagitta, a T² / 8. Over less than `PLACE_REACH` either side
    of the middle the error is much the same throughout and bends less.
    """
    share = min(1.0, speed * duration / (2 * PLACE_REACH))
    return 8 * share * float(np.median(sd_place)) / duration**2


def stop_time(x: Floats, origin: float, last: float) -> float:
    """Time at which a piece's stone stops, or `last` where it does not stop sooner.

    Parameters
    ----------
    x : (2, 3) array
        Place, velocity and acceleration at the time `origin`.
    origin, last : float
        Times, s.
    """
    braking = -float(x[:, 1] @ x[:, 2])
    if braking < 1e-9:
        return last
    return min(last, origin + float(x[:, 1] @ x[:, 1]) / braking)


def _pooled(found: Sequence[_Slowing]) -> tuple[Friction, float]:
    """Mean friction over the glides, and the spread of decelerations between them, m/s².

    Random effects after DerSimonian and Laird, 1986, Control. Clin. Trials 7, 177.
    """
    if not found:
        return Friction(), 0.0
    values = np.array([slowing.along for slowing in found])
    variance = np.array([slowing.sd for slowing in found]) ** 2
    weights = 1 / variance
    mean = float(weights @ values / weights.sum())
    between, clear = 0.0, False
    if len(values) > 1:
        excess = float(weights @ (values - mean) ** 2) - (len(values) - 1)
        between = max(0.0, excess / float(weights.sum() - (weights**2).sum() / weights.sum()))
        # Two or three glides show some spread by chance alone.
        clear = excess > 2 * float(np.sqrt(2 * (len(values) - 1)))
    weights = 1 / (variance + between)
    mean = float(weights @ values / weights.sum())
    stderr = float(np.sqrt(1 / weights.sum()))
    return Friction(mean / GRAVITY, stderr / GRAVITY), float(np.sqrt(between)) if clear else 0.0
