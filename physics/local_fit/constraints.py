"""What a fit of a shot knows besides the detections: how ice slows, and what holds at a hit.

Each is linearised and goes into the normal equations like a further measurement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.slowing import at_speed, motion_state
from curlshot.physics.local_fit.solution import POWER, Deceleration, Meeting, unknowns_of

Floats = NDArray[np.float64]

DISTANCE_SD = 0.015
"""How well two radii are known as the distance at contact (scale, shape), relative."""

MOMENTUM_SD = 0.0015
"""How well momentum is known to be kept (local scale, masses), relative to the speeds."""

DOUBT = 2.5
"""Normalised violation beyond which distance and momentum are no longer believed."""


def acceleration_prior(speed: Floats, prior: Deceleration) -> tuple[Floats, Floats]:
    """Precision, shape (2, 2), and mean of an acceleration, given the velocity, m/s."""
    size = float(np.hypot(*speed))
    if size < 0.02:
        return np.eye(2) / (prior.along**2 + prior.mean**2), np.zeros(2)
    along = speed / size
    across = np.array([-along[1], along[0]])
    # The slower a stone the more it is slowed, by all ice laws but the constant one.
    mean, unsure = at_speed(size, prior.mean, prior.share, prior.sd_share)
    width = np.hypot(prior.along, unsure)
    precision = np.outer(along, along) / width**2 + np.outer(across, across) / prior.across**2
    return precision, -mean * along


@dataclass(frozen=True)
class _State:
    """Place and velocity of one stone at a meeting, and their derivatives by all unknowns."""

    place: Floats
    speed: Floats
    by_place: Floats
    by_speed: Floats


def contact_constraints(
    theta: Floats,
    at: int,
    origins: Floats,
    meeting: Meeting,
    ranks: Sequence[tuple[int, int]],
    radius: float,
    masses: Floats | None,
) -> tuple[Floats, Floats, Floats]:
    """Linearise what holds at a contact: its time, paths that join, distance and momentum.

    Parameters
    ----------
    theta : (n,) array
        All unknowns, as in `curlshot.physics.local_fit.solution.LocalFit`.
    at : int
        Which of them is the meeting's time.
    origins : array
        Time at which each piece's state is given, s.
    meeting : Meeting
        Its time and how loose that is.
    ranks : sequence of (int, int)
        Ranks of the pieces before and after, of either stone.
    radius : float
        Of the discs, m.
    masses : (2,) array, optional
        Of the stones, where their momentum is held.

    Returns
    -------
    rows, values, sd : arrays, shapes (m, n), (m,) and (m,)
        Derivatives, values and standard deviations. A constraint that the detections contradict is
        weighted down (Cauchy weights).
    """
    t = theta[at]
    rows: list[Floats] = []
    values: list[float] = []
    sd: list[float] = []

    def constraint(value: float, width: float, row: Floats) -> None:
        rows.append(row)
        values.append(value)
        sd.append(width)

    def state(i: int) -> _State:
        own = unknowns_of(i, len(origins))
        now = motion_state(
            theta[own[:POWER]].reshape(2, 3), t - origins[i], float(theta[own[POWER]])
        )
        by_place, by_speed = np.zeros((2, len(theta))), np.zeros((2, len(theta)))
        by_place[:, own], by_speed[:, own] = now.by_place, now.by_speed
        by_place[:, at], by_speed[:, at] = now.speed, now.change
        return _State(now.place, now.speed, by_place, by_speed)

    timed = np.zeros(len(theta))
    timed[at] = 1.0
    constraint(t - meeting.t, 2 * meeting.looseness, timed)
    states = [(state(i), state(j)) for i, j in ranks]
    for old, new in states:
        gap, by_gap = new.place - old.place, new.by_place - old.by_place
        for axis in range(2):
            constraint(gap[axis], 1e-3 * radius, by_gap[axis])
    believed = len(rows)
    first, second = (old for old, _ in states)
    apart = second.place - first.place
    distance = max(float(np.hypot(*apart)), 1e-9)
    normal = apart / distance
    constraint(
        distance - 2 * radius, DISTANCE_SD * 2 * radius, normal @ (second.by_place - first.by_place)
    )
    if masses is not None:
        masses = masses / masses.mean()
        speed = sum(float(np.hypot(*old.speed)) for old, _ in states)
        change = np.array([new.speed - old.speed for old, new in states])
        slopes = np.array([new.by_speed - old.by_speed for old, new in states])
        for axis in range(2):
            width = MOMENTUM_SD * speed + 1e-4
            constraint(float(masses @ change[:, axis]), width, masses @ slopes[:, axis])
    widths = np.array(sd)
    doubt = np.abs(values) / (DOUBT * widths)
    doubt[:believed] = 0.0
    return np.array(rows), np.array(values), widths * np.sqrt(1 + doubt**2)
