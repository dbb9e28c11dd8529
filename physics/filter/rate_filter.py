"""The filter of `curlshot.physics.kalman` in closed form: three pairs of a place and its rate.

What a detection shows is the place, an error that lasts for a while and one that is anew. As the
pairs are independent, the equations of Kalman come down to a few products per step, and so do
those of the backward pass in the form of Bryson and Frazier (Bierman, 1973, Automatica 9, 503),
which inverts nothing. `curlshot.physics.filter.reference_filter` does the same with matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan, sqrt

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.filter.stretch import (
    ANYWHERE_SD,
    Gate,
    Smoothed,
    Steps,
    Stretch,
    drift,
    loss_error,
    steps,
)

Floats = NDArray[np.float64]

Triple = tuple[float, float, float]
"""Of place, rate and lasting error."""

Cov = tuple[float, float, float, float, float, float]
"""Upper triangle of a symmetric matrix, row by row."""

State = tuple[Triple, Cov]

Step = tuple[float, float, float, float, float, float]
"""As in `curlshot.physics.filter.stretch.Steps`: reach, keep, q00, q01, q11, fade."""

Innovation = tuple[float, Triple, float, float]
"""Sighted less predicted place, the covariance of the state with that difference, its variance, and
the part of this variance that is not of the place."""


@dataclass(frozen=True)
class Forward:
    """Result of the forward pass through a stretch, for each pair: x, y and θ.

    Attributes
    ----------
    drift : (n, 6) array
        What the ice was known to do, taken out of the detections:
        `curlshot.physics.filter.stretch.drift`.
    steps : sequence of Step, three times
        How place and rate go on from each time to the next.
    states : list of State, three times
        After the detection at each time.
    innovations : list of Innovation or None, three times
        Of that detection; None where there was none or it was refused.
    """

    drift: Floats
    steps: tuple[Sequence[Step], Sequence[Step], Sequence[Step]]
    states: tuple[list[State], list[State], list[State]]
    innovations: tuple[list[Innovation | None], list[Innovation | None], list[Innovation | None]]

    @property
    def normalised_innovations(self) -> Floats:
        """Normalised innovations of x, y and θ, shape (n, 3); NaN where nothing was used."""
        each = [
            [np.nan if one is None else one[0] / sqrt(one[2]) for one in of_pair]
            for of_pair in self.innovations
        ]
        return np.array(each).T


def filtered(stretch: Stretch) -> Smoothed:
    """Filter and smooth one stretch between two hits.

    Returns
    -------
    mean, spread : (n, 6) array
        x, y, vx, vy, θ, ω and their standard deviations.
    seen : (n,) int array
        Whether the detection of the place at each time was used.
    """
    way = forward(stretch)
    n = len(stretch.t)
    mean, spread = np.empty((n, 6)), np.empty((n, 6))
    for states, innovations, on, at in zip(
        way.states, way.innovations, way.steps, ([0, 2], [1, 3], [4, 5]), strict=True
    ):
        mean[:, at], spread[:, at] = _smoothed(states, innovations, on)
    mean += way.drift
    mean[stretch.rest, 2:4], mean[stretch.idle, 5] = 0.0, 0.0
    return mean, spread, np.array([one is not None for one in way.innovations[0]], int)


def forward(stretch: Stretch) -> Forward:
    """Run the forward pass through one stretch."""
    along, turning = steps(stretch)
    known = drift(stretch, along, turning)
    moves, turns = _listed(along), _listed(turning)
    places, rates = stretch.start
    anywhere = (ANYWHERE_SD[0], ANYWHERE_SD[0], ANYWHERE_SD[1])
    lasting = (stretch.slow**2).tolist()
    x, y, theta = (
        ((float(place), 0.0, 0.0), (sd**2, 0.0, 0.0, float(rate) ** 2, 0.0, error))
        for place, rate, sd, error in zip(places, rates, anywhere, lasting[0], strict=True)
    )
    values = (stretch.z - known[:, [0, 1, 4]]).tolist()
    out = Forward(known, (moves, moves, turns), ([], [], []), ([], [], []))
    of_places, of_angles = Gate(), Gate()
    for k, ((zx, zy, angle), (rx, ry, error), slow) in enumerate(
        zip(values, (stretch.sd**2).tolist(), lasting, strict=True)
    ):
        if k:
            x, y = _predicted(x, moves[k - 1], slow[0]), _predicted(y, moves[k - 1], slow[1])
            theta = _predicted(theta, turns[k - 1], slow[2])
        of_x = of_y = of_theta = None
        if not isnan(zx):
            of_x, of_y = _innovation(x, zx, rx), _innovation(y, zy, ry)
            if of_places.passes(_distance(of_x) + _distance(of_y)):
                x, y = _updated(x, of_x), _updated(y, of_y)
            else:
                of_x = of_y = None
        if not isnan(angle):
            of_theta = _innovation(theta, angle, error)
            if of_angles.passes(_distance(of_theta)):
                theta = _updated(theta, of_theta)
            else:
                of_theta = None
        for state, states in zip((x, y, theta), out.states, strict=True):
            states.append(state)
        for innovation, so_far in zip((of_x, of_y, of_theta), out.innovations, strict=True):
            so_far.append(innovation)
    return out


def angle_response(stretch: Stretch, shared: Floats) -> Floats:
    """Tell what errors that angles share make of the smoothed angle and spin: (n, 2, k).

    The filter is linear in the angles, so that it makes of them what it makes of such an error by
    itself. It does not know of them, and gives angles no other weight: a Schmidt-Kalman smoother
    (Schmidt, 1966, Advances in Control Systems 3, 293).

    Parameters
    ----------
    stretch : Stretch
        Of which the angles are smoothed.
    shared : (n, k) array
        What they are off by, rad, by k numbers of standard deviation 1.
    """
    out = np.zeros((len(stretch.t), 2, shared.shape[1]))
    if stretch.idle.all():
        out[:, 0] = np.mean(shared, axis=0)  # one angle is told
        return out
    told = np.isfinite(stretch.z[:, 2])
    if not (told.any() and shared[told].any()):
        return out
    turns = _listed(steps(stretch)[1])
    rate = float(stretch.start[1][2])
    errors, lasting = (stretch.sd[:, 2] ** 2).tolist(), (stretch.slow[:, 2] ** 2).tolist()
    start: State = ((0.0, 0.0, 0.0), (ANYWHERE_SD[1] ** 2, 0.0, 0.0, rate**2, 0.0, lasting[0]))
    for column, of_one in enumerate(shared.T.tolist()):
        state, states, innovations = start, [], []
        for k, (value, seen, error) in enumerate(zip(of_one, told.tolist(), errors, strict=True)):
            if k:
                state = _predicted(state, turns[k - 1], lasting[k])
            innovation = _innovation(state, value, error) if seen else None
            if innovation is not None:
                state = _updated(state, innovation)
            states.append(state)
            innovations.append(innovation)
        out[:, :, column] = _smoothed(states, innovations, turns)[0]
    out[stretch.idle, 1] = 0.0
    return out


def shared_response(stretch: Stretch, rise: Floats) -> Floats:
    """Tell what the smoothed angle and spin are off by together: (n, 2, k + 1).

    By what angles share, `rise` (n, k), as for `angle_response`, and last by one standard error of
    the loss of spin.
    """
    lost = loss_error(stretch)
    out = angle_response(stretch, np.column_stack([rise, lost[:, 0]]))
    out[:, :, -1] -= lost
    return out


def _listed(way: Steps) -> list[Step]:
    columns = (way.reach, way.keep, way.q00, way.q01, way.q11, way.fade)
    return list(zip(*(column.tolist() for column in columns), strict=True))


def _predicted(state: State, step: Step, slow: float) -> State:
    """Predict one step ahead, to where lasting errors have the variance `slow`."""
    (place, rate, lasting), (p00, p01, p02, p11, p12, p22) = state
    reach, keep, q00, q01, q11, fade = step
    cross = p01 + reach * p11
    return (
        (place + reach * rate, keep * rate, fade * lasting),
        (
            p00 + reach * (p01 + cross) + q00,
            keep * cross + q01,
            fade * (p02 + reach * p12),
            keep * keep * p11 + q11,
            fade * keep * p12,
            slow + fade * fade * (p22 - slow),
        ),
    )


def _innovation(state: State, value: float, variance: float) -> Innovation:
    """Compare a detection of the place with the state."""
    (place, _, lasting), (p00, p01, p02, _, p12, p22) = state
    c = (p00 + p02, p01 + p12, p02 + p22)
    rest = c[2] + variance
    return value - place - lasting, c, c[0] + rest, rest


def _distance(innovation: Innovation) -> float:
    """Squared normalised innovation."""
    return innovation[0] ** 2 / innovation[2]


def _updated(state: State, innovation: Innovation) -> State:
    (place, rate, lasting), (p00, p01, p02, p11, p12, p22) = state
    error, (c0, c1, c2), total, _ = innovation
    g0, g1, g2 = c0 / total, c1 / total, c2 / total
    return (
        (place + g0 * error, rate + g1 * error, lasting + g2 * error),
        (p00 - g0 * c0, p01 - g0 * c1, p02 - g0 * c2, p11 - g1 * c1, p12 - g1 * c2, p22 - g2 * c2),
    )


def _smoothed(
    states: Sequence[State], innovations: Sequence[Innovation | None], way: Sequence[Step]
) -> tuple[Floats, Floats]:
    """Run the backward pass, from the last time to the first.

    Returns place and rate, and their standard deviations, each (n, 2).
    """
    l0 = l1 = l2 = 0.0
    m00 = m01 = m02 = m11 = m12 = m22 = 0.0
    slopes: list[Triple] = []
    bends: list[Cov] = []
    for k in range(len(states) - 1, -1, -1):
        slopes.append((l0, l1, l2))
        bends.append((m00, m01, m02, m11, m12, m22))
        innovation = innovations[k]
        if innovation is not None:
            error, (c0, c1, c2), total, rest = innovation
            # Columns of 1 − gain · shown: (a, −b, −c), (0, 1, 0) and (−d, −b, 1 − c).
            a, b, c, d = rest / total, c1 / total, c2 / total, c0 / total
            n0, n1, n2 = (
                a * m00 - b * m01 - c * m02,
                a * m01 - b * m11 - c * m12,
                a * m02 - b * m12 - c * m22,
            )
            o1, o2 = n1 + m12 - m01, n2 + m22 - m02
            pull = a * l0 - b * l1 - c * l2 - error / total
            l0, l2 = pull, pull + l2 - l0
            bend = a * n0 - b * n1 - c * n2 + 1.0 / total
            cross = (1.0 - c) * n2 - d * n0 - b * n1 + 1.0 / total
            m22 = (1.0 - c) * o2 - d * (n0 + m02 - m00) - b * o1 + 1.0 / total
            m00, m01, m02, m12 = bend, n1, cross, o1
        if k:
            reach, keep, _, _, _, fade = way[k - 1]
            l0, l1, l2 = l0, reach * l0 + keep * l1, fade * l2
            half = reach * m00 + keep * m01
            m00, m01, m02, m11, m12, m22 = (
                m00,
                half,
                fade * m02,
                reach * half + keep * (reach * m01 + keep * m11),
                fade * (reach * m02 + keep * m12),
                fade * fade * m22,
            )
    means = np.array([mean for mean, _ in states])
    covs = _matrices([cov for _, cov in states])
    change = covs[:, :2] @ np.array(slopes[::-1])[:, :, None]
    less = np.einsum("nij,njk,nik->ni", covs[:, :2], _matrices(bends[::-1]), covs[:, :2])
    variance = covs[:, [0, 1], [0, 1]] - less
    return means[:, :2] - change[..., 0], np.sqrt(np.maximum(variance, 0.0))


def _matrices(triangles: Sequence[Cov]) -> Floats:
    return np.asarray(np.array(triangles)[:, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]])
