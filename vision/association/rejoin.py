"""A stone that was hit where nobody saw it: its two tracks are one.

A moving stone that goes out of sight is expected to glide on, one at rest to stay
(`vision.association.follow`). Where it is hit just then, behind a sweeper say, it comes back where
it is not expected, as a new track. The way of that track, followed back, leads to where the first
one ends: of a stone that moved, to when it was lost; of one that rested, to when it was hit at some
time since.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot

from vision.association.follow import OTHER, PATIENCE, REACH, Track
from vision.association.lead import DECELERATION
from vision.detection.appearance import colour_difference

BEGINNING = 0.4
"""Of a track, s: what its first velocity is told from."""

LEAST_WAY = 0.3
"""Way in that time by which a track moves, radii."""

STRAY = 0.5
"""How much farther from the end of the first track the way may lead per second unseen, radii."""


def rejoined(tracks: Sequence[Track], radius: float, other: float = OTHER) -> list[Track]:
    """Join each track that begins in motion to the one whose stone it goes on with.

    Parameters
    ----------
    tracks : sequence of Track
        In order of birth; those that go on are made longer.
    radius : float
        Of the discs, m.
    other : float
        Difference of cap colours, L*a*b* units, that says: another stone.

    Returns
    -------
    list of Track
        In order of birth. Where several could be meant, none is.
    """
    out: list[Track] = []
    for track in tracks:
        before = [first for first in out if _goes_on(first, track, radius, other)]
        if len(before) == 1:
            before[0].go_on(track)
        else:
            out.append(track)
    return out


def _goes_on(first: Track, second: Track, radius: float, other: float) -> bool:
    """Whether a track may be that of a stone that has gone out of sight."""
    unseen = second.times[0] - first.times[-1]
    if not 0 < unseen < PATIENCE:
        return False
    if colour_difference(first.colour, second.colour) > other:
        return False
    begun = [k for k, t in enumerate(second.times) if t - second.times[0] <= BEGINNING]
    here, there = second.sightings[0], second.sightings[begun[-1]]
    dx, dy = there.x - here.x, there.y - here.y
    way = hypot(dx, dy)
    if way < LEAST_WAY * radius:
        return False
    speed = way / (second.times[begun[-1]] - second.times[0])
    back = (speed + 0.5 * DECELERATION * unseen) * unseen / way
    end = first.sightings[-1]
    if first.speed == 0:
        nearest = ((here.x - end.x) * dx + (here.y - end.y) * dy) / way**2
        back = min(max(nearest, 0.0), back)
    off = hypot(here.x - back * dx - end.x, here.y - back * dy - end.y)
    return off < (REACH + STRAY * unseen) * radius
