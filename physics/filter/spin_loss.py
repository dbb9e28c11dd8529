"""How much spin the ice takes, told by the angles of all stones of a shot.

A gliding stone loses spin as 1 / v (FCV1: Uehara and Ito, 2021): by how much differs from ice to
ice, some take none, but on one ice it is the same for all stones all the time. A single angle
tells nothing of it, a glide of seconds a little, all glides of a shot as a rule more than is
known beforehand. What is left open then is one number, not a noise that is anew at each moment.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import (
    ANGLE_MEMORY,
    SPIN_LOSS,
    SPIN_LOSS_SD,
    Stretch,
    loss_rate,
)

Floats = NDArray[np.float64]

FEWEST, MOST, SHORTEST = 8, 40, 0.5
"""Angles from which on a glide is asked, how many of it are looked at, and how long it lasts, s."""

SLOWEST, IDLE = 0.05, 0.15
"""Speed, m/s, and spin, rad/s, below which a stone is not asked: it may have stopped."""

MOST_LOST = 0.1
"""Largest loss that is told, four times FCV1's."""

LEAST_NEW = 1e-3
"""What an angle is off by anew at least, rad, beside what lasts: exact ones would outweigh all."""


def spin_loss(glides: Sequence[tuple[Stretch, Floats]]) -> tuple[float, float]:
    """Tell how much spin stones lose, times their speed.

    Each piece of a stretch is fitted by θ₀ + ω₀ t and the loss, by generalised least squares with
    the errors that angles have anew, those that last for a while and those that all share. What is
    known beforehand (`curlshot.physics.filter.stretch.SPIN_LOSS`) and all glides are pooled; where
    they agree less than their errors say, the pooled one is larger by Birge's ratio.

    Parameters
    ----------
    glides : sequence of (Stretch, ndarray)
        Stones between two hits, and what their angles are off by together, (n, k), rad, by k
        numbers of standard deviation 1.

    Returns
    -------
    loss, sd : float
        rad/s² times m/s, 0 to `MOST_LOST`, and its standard error.
    """
    told = [(SPIN_LOSS, SPIN_LOSS_SD)]
    told += [each for stretch, together in glides for each in _each(stretch, together)]
    value, sd = np.array(told).T
    weight = sd**-2
    mean = float(weight @ value / weight.sum())
    apart = float(weight @ (value - mean) ** 2) / max(len(value) - 1, 1)
    return min(max(mean, 0.0), MOST_LOST), float(np.sqrt(max(apart, 1.0) / weight.sum()))


def _each(stretch: Stretch, together: Floats) -> Iterator[tuple[float, float]]:
    """Give the loss that each piece of a stretch tells."""
    speed = np.hypot(*stretch.speed.T)
    asked = np.isfinite(stretch.z[:, 2]) & ~stretch.rest & (speed > SLOWEST)
    for piece in np.unique(stretch.piece[asked]):
        rows = np.flatnonzero(asked & (stretch.piece == piece))
        if len(rows) >= FEWEST and stretch.t[rows[-1]] - stretch.t[rows[0]] >= SHORTEST:
            some = rows[np.linspace(0, len(rows) - 1, min(len(rows), MOST)).astype(int)]
            told = _of_piece(stretch, some, together[some], speed[some])
            if told is not None:
                yield told


def _of_piece(
    stretch: Stretch, rows: NDArray[np.intp], together: Floats, speed: Floats
) -> tuple[float, float] | None:
    """Fit the angles of a piece; None where it hardly turns."""
    t, theta = stretch.t[rows] - stretch.t[rows[0]], stretch.z[rows, 2]
    spin = float(np.polyfit(t, theta, 1)[0])
    if abs(spin) < IDLE:
        return None
    new, lasting = np.maximum(stretch.sd[rows, 2], LEAST_NEW), stretch.slow[rows, 2]
    apart = np.abs(np.subtract.outer(t, t))
    cov = np.diag(new**2) + np.outer(lasting, lasting) * np.exp(-apart / ANGLE_MEMORY)
    cov += together @ together.T
    rate = loss_rate(SPIN_LOSS, speed) / SPIN_LOSS
    lost = -np.copysign(1.0, spin) * _summed(t, _summed(t, rate))
    basis = np.stack([np.ones_like(t), t, lost], axis=1)
    weighed = np.linalg.solve(cov, basis)
    spread = np.linalg.inv(basis.T @ weighed)
    fitted = spread @ weighed.T @ theta
    left = theta - basis @ fitted
    square = float(left @ np.linalg.solve(cov, left)) / (len(t) - 3)
    return float(fitted[2]), float(np.sqrt(spread[2, 2] * max(square, 1.0)))


def _summed(t: Floats, rate: Floats) -> Floats:
    """Integral from the first time on, by trapezes."""
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(t)
    return np.concatenate([[0.0], np.cumsum(steps)])
