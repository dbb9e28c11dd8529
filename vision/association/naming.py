"""Which stone moves first: what the names go by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from curlshot.data.tracks import stone_name
from curlshot.vision.association.follow import Track

LEFT, JITTER = 0.25, 6.0
"""How far from where it lay a stone must be to have left: in radii, and in its usual distance from
there while it lay."""

FEW = 5
"""Frames over which the first speed is taken: from one to the next it is told badly."""


def first_motion(track: Track, radius: float) -> float | None:
    """Time at which a stone first moved, s; None for one that stays where it is.

    A stone moves when it leaves its first place for good by more than its jitter and a
    share of its radius; the time is carried back to when it was still there.
    """
    places = track.detections.columns("x", "y").T
    times = np.array(track.times)
    if len(times) < 3:
        return None
    least = LEFT * radius
    start = places[0]
    if float(np.hypot(*(places - start).T).max()) < least:
        return None
    # Its first place is that of all its first detections that are alike.
    still = 1
    while still < len(times) and np.hypot(*(places[still] - np.median(places[:still], 0))) < least:
        still += 1
    if still >= len(times):
        return None
    home = np.median(places[:still], axis=0)
    away = np.hypot(*(places - home).T)
    jitter = float(np.median(away[:still])) if still > 3 else 0.0
    limit = max(least, JITTER * jitter)
    beyond = away > limit
    if beyond.sum() < min(3, len(times) - still):
        return None
    first = int(beyond.argmax())
    if first == 0:
        return float(times[0])
    last = min(first + 3, len(times) - 1)
    speed = (away[last] - away[first]) / (times[last] - times[first]) if last > first else 0.0
    start = times[first] - away[first] / speed if speed > 0 else times[first - 1]
    # Within a frame of its first it may as well have moved before.
    return float(start if start > times[1] else times[0])


def _first_speed(track: Track) -> float:
    """Mean speed over the first few frames, m/s."""
    few = min(FEW, len(track.times) - 1)
    first, last = track.detections[0], track.detections[few]
    wait = track.times[few] - track.times[0]
    return float(np.hypot(last.x - first.x, last.y - first.y) / wait) if wait > 0 else 0.0


def named_by_motion(
    tracks: Sequence[Track], radius: float
) -> tuple[dict[str, Track], tuple[str, ...]]:
    """Name stones by the order in which they first move: A the thrown one, then B, C and so on.

    Then those that stay where they are, by their distance to the tee.

    Returns
    -------
    named : dict of str to Track
        In the order of their names; the faster first of those that move at the same time.
    rest : tuple of str
        Names of those that stay.
    """
    moved: list[tuple[float, float, int]] = []
    rest: list[tuple[float, int]] = []
    for number, track in enumerate(tracks):
        start = first_motion(track, radius)
        if start is None:
            x, y = np.median(track.detections.columns("x", "y"), axis=1)
            rest.append((float(np.hypot(x, y)), number))
        else:
            moved.append((start, -_first_speed(track), number))
    order = [number for *_, number in sorted(moved)] + [number for _, number in sorted(rest)]
    named = {stone_name(rank): tracks[number] for rank, number in enumerate(order)}
    return named, tuple(named)[len(moved) :]
