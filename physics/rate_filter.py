"""The filter of `physics.kalman` in closed form: three pairs of a place and its rate.

As the pairs are independent, the equations of Kalman and those of Rauch, Tung and Striebel
(1965, AIAA J. 3, 1445) come down to a few products per step. `physics.reference_filter` does
the same with matrices.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from physics.stretch import ANYWHERE_SD, GATE, PATIENCE, Estimates, Steps, Stretch, drift, steps

Floats = NDArray[np.float64]

Pair = tuple[float, float, float, float, float]
"""Place, rate, and the variance of the place, the covariance and the variance of the rate."""

Step = tuple[float, float, float, float, float]
"""As in `physics.stretch.Steps`: reach, keep, q00, q01, q11."""


def filtered(stretch: Stretch) -> Estimates:
    """Filter and smooth one stretch between two hits.

    Returns
    -------
    mean, spread : (n, 6) array
        x, y, vx, vy, θ, ω and their standard deviations.
    seen : (n,) int array
        Whether the sighting of the place at each time was used.
    """
    along, turning = steps(stretch)
    known = drift(stretch, along)
    places, rates = stretch.start
    x, y, theta = (
        (float(place), 0.0, sd**2, 0.0, float(rate) ** 2)
        for place, rate, sd in zip(
            places, rates, (ANYWHERE_SD[0], ANYWHERE_SD[0], ANYWHERE_SD[1]), strict=True
        )
    )
    moves, turns = _listed(along), _listed(turning)
    values = stretch.z - known[:, [0, 1, 4]]
    sightings = zip(values.tolist(), (stretch.sd**2).tolist(), strict=True)
    pairs: tuple[list[Pair], list[Pair], list[Pair]] = ([], [], [])
    seen = np.zeros(len(stretch.t), dtype=int)
    refused = wrong = 0
    for k, ((zx, zy, angle), (rx, ry, error)) in enumerate(sightings):
        if k:
            x, y = _predicted(x, moves[k - 1]), _predicted(y, moves[k - 1])
            theta = _predicted(theta, turns[k - 1])
        if zx == zx:  # not NaN
            if _distance(x, zx, rx) + _distance(y, zy, ry) < GATE or refused >= PATIENCE:
                seen[k], refused = 1, 0
                x, y = _updated(x, zx, rx), _updated(y, zy, ry)
            else:
                refused += 1
        if angle == angle:
            if _distance(theta, angle, error) < GATE or wrong >= PATIENCE:
                wrong = 0
                theta = _updated(theta, angle, error)
            else:
                wrong += 1
        for pair, so_far in zip((x, y, theta), pairs, strict=True):
            so_far.append(pair)
    mean, spread = np.empty((len(seen), 6)), np.empty((len(seen), 6))
    for so_far, way, at in zip(pairs, (moves, moves, turns), ([0, 2], [1, 3], [4, 5]), strict=True):
        smoothed = np.array(_smoothed(so_far, way))
        mean[:, at] = smoothed[:, :2]
        spread[:, at] = np.sqrt(np.maximum(smoothed[:, [2, 4]], 0.0))
    mean += known
    mean[stretch.rest, 2:4], mean[stretch.idle, 5] = 0.0, 0.0
    return mean, spread, seen


def _listed(way: Steps) -> list[Step]:
    columns = (way.reach, way.keep, way.q00, way.q01, way.q11)
    return list(zip(*(column.tolist() for column in columns), strict=True))


def _predicted(pair: Pair, step: Step) -> Pair:
    place, rate, p00, p01, p11 = pair
    reach, keep, q00, q01, q11 = step
    cross = p01 + reach * p11
    return (
        place + reach * rate,
        keep * rate,
        p00 + reach * (p01 + cross) + q00,
        keep * cross + q01,
        keep * keep * p11 + q11,
    )


def _distance(pair: Pair, value: float, variance: float) -> float:
    """Squared normalised innovation of a sighting of the place."""
    return (value - pair[0]) ** 2 / (pair[2] + variance)


def _updated(pair: Pair, value: float, variance: float) -> Pair:
    place, rate, p00, p01, p11 = pair
    total = p00 + variance
    error = (value - place) / total
    left = variance / total
    return (
        place + p00 * error,
        rate + p01 * error,
        p00 * left,
        p01 * left,
        p11 - p01 * p01 / total,
    )


def _smoothed(pairs: Sequence[Pair], way: Sequence[Step]) -> list[Pair]:
    """Take what came later into account, from the last to the first."""
    after = pairs[-1]
    out = [after]
    for pair, step in zip(pairs[-2::-1], way[::-1], strict=True):
        place, rate, p00, p01, p11 = pair
        reach, keep, *_ = step
        ahead, going, f00, f01, f11 = _predicted(pair, step)
        # Gain: covariance with the state ahead, over the variance of that state.
        c00, c10 = p00 + reach * p01, p01 + reach * p11
        c01, c11 = keep * p01, keep * p11
        size = f00 * f11 - f01 * f01
        g00, g01 = (c00 * f11 - c01 * f01) / size, (c01 * f00 - c00 * f01) / size
        g10, g11 = (c10 * f11 - c11 * f01) / size, (c11 * f00 - c10 * f01) / size
        d0, d1 = after[0] - ahead, after[1] - going
        e00, e01, e11 = after[2] - f00, after[3] - f01, after[4] - f11
        after = (
            place + g00 * d0 + g01 * d1,
            rate + g10 * d0 + g11 * d1,
            p00 + g00 * (g00 * e00 + g01 * e01) + g01 * (g00 * e01 + g01 * e11),
            p01 + g10 * (g00 * e00 + g01 * e01) + g11 * (g00 * e01 + g01 * e11),
            p11 + g10 * (g10 * e00 + g11 * e01) + g11 * (g10 * e01 + g11 * e11),
        )
        out.append(after)
    return out[::-1]
