"""What a fit of a shot knows besides the sightings: how ice slows, and what holds at a hit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from physics.shot_fit import Deceleration, Meeting

Floats = NDArray[np.float64]

DISTANCE_SD = 0.015
"""How well two radii are known as the distance at contact (scale, shape), relative."""

MOMENTUM_SD = 0.0015
"""How well momentum is known to be kept (local scale, masses), relative to the speeds."""

DOUBT = 2.5
"""Normalised violation beyond which distance and momentum are no longer believed."""

SLOW, SLOWEST = 0.015, 0.06
"""What the deceleration of a slow stone may differ from the others', m²/s³, and the speed (m/s)
at which that grows no more: FCV1's (Uehara and Ito, 2021), whose friction has such a term."""


def slowing(speed: Floats, prior: Deceleration) -> tuple[Floats, Floats]:
    """Precision, shape (2, 2), and mean of an acceleration, given the velocity, m/s."""
    size = float(np.hypot(*speed))
    if size < 0.02:
        return np.eye(2) / (prior.along**2 + prior.mean**2), np.zeros(2)
    along = speed / size
    across = np.array([-along[1], along[0]])
    # The slower a stone the more it is slowed, by all ice laws but the constant one.
    width = max(prior.along, SLOW / (size + SLOWEST))
    precision = np.outer(along, along) / width**2 + np.outer(across, across) / prior.across**2
    return precision, -prior.mean * along


def meeting_rules(
    theta: Floats,
    at: int,
    origins: Floats,
    meeting: Meeting,
    ranks: Sequence[tuple[int, int]],
    radius: float,
    masses: Floats | None,
) -> tuple[Floats, Floats, Floats]:
    """Linearise what holds at a meeting: its time, paths that join, distance and momentum.

    Parameters
    ----------
    theta : (n,) array
        All unknowns, as in `physics.shot_fit.ShotFit`.
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
    rows, values, sd : arrays, shapes (rules, n), (rules,) and (rules,)
        Derivatives, values and standard deviations. A rule that the sightings contradict has
        less of a say (Cauchy weights).
    """
    t = theta[at]
    rows: list[Floats] = []
    values: list[float] = []
    sd: list[float] = []

    def rule(value: float, width: float) -> Floats:
        row = np.zeros(len(theta))
        rows.append(row)
        values.append(value)
        sd.append(width)
        return row

    def state(i: int) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        tau = t - origins[i]
        x = theta[6 * i : 6 * i + 6].reshape(2, 3)
        one, slope = np.array([1.0, tau, 0.5 * tau * tau]), np.array([0.0, 1.0, tau])
        return x @ one, x @ slope, x[:, 2], one, slope

    rule(t - meeting.t, 2 * meeting.looseness)[at] = 1.0
    states = [(state(i), state(j)) for i, j in ranks]
    for (i, j), (old, new) in zip(ranks, states, strict=True):
        for axis in range(2):
            row = rule(new[0][axis] - old[0][axis], 1e-3 * radius)
            row[6 * j + 3 * axis : 6 * j + 3 * axis + 3] = new[3]
            row[6 * i + 3 * axis : 6 * i + 3 * axis + 3] = -old[3]
            row[at] = new[1][axis] - old[1][axis]
    believed = len(rows)
    apart = states[1][0][0] - states[0][0][0]
    distance = max(float(np.hypot(*apart)), 1e-9)
    normal = apart / distance
    row = rule(distance - 2 * radius, DISTANCE_SD * 2 * radius)
    for sign, (i, _), (old, _) in zip((-1.0, 1.0), ranks, states, strict=True):
        for axis in range(2):
            row[6 * i + 3 * axis : 6 * i + 3 * axis + 3] = sign * normal[axis] * old[3]
        row[at] += sign * float(normal @ old[1])
    if masses is not None:
        masses = masses / masses.mean()
        speed = sum(float(np.hypot(*old[1])) for old, _ in states)
        for axis in range(2):
            change = [float(new[1][axis] - old[1][axis]) for old, new in states]
            row = rule(float(masses @ change), MOMENTUM_SD * speed + 1e-4)
            for mass, (i, j), (old, new) in zip(masses, ranks, states, strict=True):
                row[6 * j + 3 * axis : 6 * j + 3 * axis + 3] += mass * new[4]
                row[6 * i + 3 * axis : 6 * i + 3 * axis + 3] -= mass * old[4]
                row[at] += mass * float(new[2][axis] - old[2][axis])
    width = np.array(sd)
    doubt = np.abs(values) / (DOUBT * width)
    doubt[:believed] = 0.0
    return np.array(rows), np.array(values), width * np.sqrt(1 + doubt**2)
