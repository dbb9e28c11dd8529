"""What is known of the laws before any detection, with its sources."""

from __future__ import annotations

from dataclasses import dataclass, replace

from curlshot.data.results import Estimate
from curlshot.data.sheet import curling_size
from curlshot.physics.filter.slowing import V_C

SLOPE, KNEE, TURN = Estimate(0.002, 0.001), Estimate(V_C, 0.04), Estimate(0.0, 0.01)
"""What is known of a and v_c in μ(v) = a / (v + v_c) + b, m/s, where friction falls (a is 0.002 in
FCV1, some 0.0035 in Penner's law; no ice is known whose friction hardly falls), and of the turn of
a path at 1 m/s, rad/s (0.0082 in FCV1)."""

LOSS = Estimate(0.0125, 0.0125)
"""What is known of the loss of spin times speed, m rad/s³: 0.025 in FCV1, and other ice may take
none. When a slow spin dies tells for how long its stone curls: held at a wrong value it made e of
a shot up to ten of its errors wrong."""

INERTIA = Estimate(0.5, 0.03)
"""What is known of k in a curling stone's moment of inertia k m R²: 0.5 for a cylinder, less the
rounder it is."""


SPIN = Estimate(0.0, 3.0)
"""What is known of the spin of a disc that moves, rad/s."""


@dataclass(frozen=True)
class Priors:
    """What is known of the laws before any detection.

    Attributes
    ----------
    restitution : Estimate
        0.83 ± 0.06 is what the study of the 2018 Olympic final quotes; simulators take 0.5
        to 1.
    stone_friction : Estimate
        Between two stones; nobody seems to have measured it, simulators take 0 to 0.2.
    friction : Estimate
        Of the ice; 0.006 to 0.016 was measured by Li et al., 2022, Lubricants 10, 265.
    size : Estimate
        Distance at contact over two radii.
    slope, v_c, turn, loss : Estimate
        How friction falls, paths curl and spins are lost, as at `SLOPE`, `KNEE`, `TURN` and `LOSS`.
    inertia : Estimate
        k in the moment of inertia k m R², as at `INERTIA`.
    """

    restitution: Estimate
    stone_friction: Estimate
    friction: Estimate
    size: Estimate
    slope: Estimate = SLOPE
    v_c: Estimate = KNEE
    turn: Estimate = TURN
    loss: Estimate = LOSS
    inertia: Estimate = INERTIA


RESTITUTION, STONE_FRICTION, FRICTION = 0.83, 0.05, 0.0109
"""What is assumed where a shot tells nothing."""

LITERATURE = Priors(
    Estimate(RESTITUTION, 0.06),
    Estimate(STONE_FRICTION, 0.05),
    Estimate(FRICTION, 0.003),
    Estimate(1.0, 0.01),
)
"""Priors of a shot of curling stones of which nothing is known yet; sources at `Priors`."""


def literature(radius: float) -> Priors:
    """Return priors of a shot of which nothing is known yet, for discs of a radius, m.

    Curling stones have those of `LITERATURE`. Other discs may glide on anything, and bounce less
    or more: 0.56 was measured of pucks with soft rims, billiard balls have 0.92 to 0.98.
    """
    if curling_size(radius):
        return LITERATURE
    anything = loose_priors(radius).friction
    return replace(LITERATURE, restitution=Estimate(0.7, 0.2), friction=anything)


def loose_priors(radius: float) -> Priors:
    """Return priors that leave the say to the detections.

    Only the friction is that of curling ice where the discs have the size of curling stones:
    half a second of a glide does not tell it, and velocities at a hit depend on it.
    """
    curling = curling_size(radius)
    return Priors(
        restitution=Estimate(0.8, 1.0),
        stone_friction=Estimate(0.1, 0.3),
        friction=Estimate(0.0105, 0.004) if curling else Estimate(0.01, 0.1),
        size=Estimate(1.0, 0.015 if curling else 0.05),
    )
