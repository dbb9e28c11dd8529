"""Restitution and friction as the study of the 2018 Olympic final had them, for comparison.

Velocities are means of finite differences over a window on either side of a hit, the normal
goes through the centres as they were last seen before it, and friction is what brings a stone
from its velocity after a hit to rest in the time that it takes. That velocity is the mean over
the window, half a window after the hit: the friction comes out low by half the window over the
time to rest, as the study's does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from curlshot.data.results import Estimate, Hit, Method, NotedEstimate
from curlshot.data.sheet import GRAVITY
from curlshot.physics.local_fit.traces import Trace

Floats = NDArray[np.float64]

WINDOW = 0.5
"""Longest window on either side of a hit, s: "long enough to find an average velocity, yet short
enough to avoid decay due to friction"."""

STOPPED = 0.05
"""Mean speed over a window below which a stone has come to rest, m/s."""


def by_finite_differences(
    known: Mapping[str, Trace], collisions: Sequence[Hit], ends: Mapping[str, float]
) -> Method:
    """Restitution of each hit, their mean, and the mean friction of stones that come to rest.

    Parameters
    ----------
    known : mapping
        Stone to its detections.
    collisions : sequence of Hit
        The hits in order of time; only their times and stones are used.
    ends : mapping
        Stone to the time at which its last glide ends in rest, s, of those that are seen to.
    """
    hits = [_restitution(known, hit, collisions) for hit in collisions]
    slowed = [
        _friction(known[stone], own[-1].t, end)
        for stone, end in ends.items()
        if (own := [hit for hit in collisions if stone in hit.stones])
    ]
    return Method(
        _mean(hits),
        _mean(slowed),
        NotedEstimate(note="finite differences do not give the friction between the stones"),
        hits=tuple(hits),
        note=(
            f"mean finite differences over at most {WINDOW:g} s on either side of a hit; errors"
            " from noise alone"
        ),
    )


def _restitution(known: Mapping[str, Trace], hit: Hit, others: Sequence[Hit]) -> Estimate:
    """Ratio of the normal speeds after and before a hit."""
    places, sides = [], []
    for stone in hit.stones:
        times = [other.t for other in others if stone in other.stones and other.t != hit.t]
        low = max([t for t in times if t < hit.t], default=-np.inf)
        high = min([t for t in times if t > hit.t], default=np.inf)
        before = known[stone].between(max(low, hit.t - WINDOW), hit.t)
        after = known[stone].between(hit.t, min(high, hit.t + WINDOW))
        if before.sum() < 2 or after.sum() < 2:
            return Estimate()
        places.append(known[stone].xy[before][-1])
        sides.append((_velocity(known[stone], before), _velocity(known[stone], after)))
    normal = (places[1] - places[0]) / np.hypot(*(places[1] - places[0]))
    (v1, w1), (v2, w2) = sides
    closing, leaving = (v1[0] - v2[0]) @ normal, (w2[0] - w1[0]) @ normal
    if closing <= 0:
        return Estimate()
    value = float(leaving / closing)
    errors = np.hypot(v1[1], v2[1]) * value, np.hypot(w1[1], w2[1])
    return Estimate(value, float(np.hypot(*errors) / closing))


def _velocity(trace: Trace, inside: NDArray[np.bool_]) -> tuple[Floats, float]:
    """Mean of the finite differences, m/s, and the error that the noise of places gives it.

    Each counts for the time it spans, as they do alike where frames follow each other evenly.
    """
    t, xy, sd = trace.t[inside], trace.xy[inside], trace.sd[inside]
    return (xy[-1] - xy[0]) / (t[-1] - t[0]), float(np.sqrt(2) * np.mean(sd) / (t[-1] - t[0]))


def _friction(trace: Trace, start: float, end: float) -> Estimate:
    """Friction that stops a stone in the time from its hit to its rest."""
    after = trace.between(start, min(start + WINDOW, end))
    if after.sum() < 2 or end <= start:
        return Estimate()
    velocity, error = _velocity(trace, after)
    speed = float(np.hypot(*velocity))
    if speed < STOPPED:
        return Estimate()
    return Estimate(speed / (GRAVITY * (end - start)), error / (GRAVITY * (end - start)))


def _mean(found: Sequence[Estimate]) -> Estimate:
    """Plain mean of those that are known, and its error from theirs."""
    values = [one.value for one in found if one.value is not None]
    errors = [one.stderr for one in found if one.stderr is not None]
    if not values:
        return Estimate()
    return Estimate(float(np.mean(values)), float(np.sqrt(np.sum(np.square(errors))) / len(values)))
