"""Stones that come back into sight: which of those that went out of it each of them is.

`curlshot.vision.association.follow` takes what comes for the stone that is expected next to it. One
that is hit while people hide it comes out elsewhere, and perhaps another one where it was expected.
So all gaps are looked at once more when both of their ends are known. Up to a hit a stone goes as
it was last seen, from then on as it is seen next: at the hit the two ways are at the same place at
the same time, and without a hit they are one. Of the stones that went out of sight and those that
came back, those are one that together do so best.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.association.assign import assign
from curlshot.vision.association.follow import BIRTHS, PATIENCE, Track
from curlshot.vision.association.lead import DECELERATION
from curlshot.vision.detection.appearance import OTHER_STONE, colour_difference
from curlshot.vision.detection.detection import Detection

Array = NDArray[np.float64]

GAP = 0.25
"""Out of sight for longer than this, s, a stone may be another one than that expected there."""

WINDOW = 0.2
"""Time from which it is told how a stone moves, s: a longer one may have a hit in it, just before
the stone went out of sight."""

SLOW = 0.04
"""Speed, m/s, that detections of one at rest may show: 3 mm off, and seldom more. One that
goes as slowly rests 8 mm on."""

PLACE_SD, SPEED_SD, SLOWING_SD = 0.2, 0.15, 0.2
"""Of where a stone is expected in radii, of its speed and of what it loses of that, each per s:
2 cm/s and 0.03 m/s², as much as ice differs."""

MISSED = 12.0
"""Squared distance of two ways, in its variances, from which on they are not of one stone."""

TAPPED = 0.9 * MISSED
"""The same for one that rests here and then there, which tells no way: it was tapped, or pushed, if
no other stone comes from where the one lay."""

STEPS = 200
"""Times in a gap at which it is looked how near the two ways are."""


@dataclass(frozen=True)
class _Motion:
    """How a stone moves at one end of a stretch in which it is seen.

    Attributes
    ----------
    t : float
        s.
    place, velocity : ndarray, shape (2,)
        m and m/s.
    """

    t: float
    place: Array
    velocity: Array

    @classmethod
    def of(cls, times: Array, seen: Sequence[Detection]) -> _Motion:
        """From detections on a straight way, the one at the end first."""
        end = float(times[0])
        places = np.array([(s.x, s.y) for s in seen])
        basis = np.stack([np.ones(len(times)), times - end], axis=1)
        (place, velocity), *_ = np.linalg.lstsq(basis, places, rcond=None)
        return cls(end, place, velocity)

    @property
    def speed(self) -> float:
        """In m/s; 0 for one at rest."""
        speed = float(np.hypot(*self.velocity))
        return speed if speed > SLOW else 0.0

    def at(self, t: Array) -> Array:
        """Give its places (n, 2) at times, m: it comes to rest, and has been faster before."""
        if not self.speed:
            return np.tile(self.place, (len(t), 1))
        step = np.minimum(t - self.t, self.speed / DECELERATION)
        path = step - 0.5 * DECELERATION * step**2 / self.speed
        return np.asarray(self.place + path[:, None] * self.velocity)

    def variance(self, t: Array, radius: float) -> Array:
        """Of its places at times, m² per axis."""
        wait = np.abs(t - self.t) if self.speed else np.zeros(len(t))
        sd = np.hypot(PLACE_SD, np.hypot(SPEED_SD * wait, 0.5 * SLOWING_SD * wait**2))
        return np.asarray((sd * radius) ** 2)


@dataclass(frozen=True)
class _Stretch:
    """A part of a track without a long gap: detections from the one to before the other."""

    track: Track
    begin: int
    end: int

    @cached_property
    def first(self) -> _Motion:
        return self._motion(range(self.begin, self.end))

    @cached_property
    def last(self) -> _Motion:
        return self._motion(range(self.end - 1, self.begin - 1, -1))

    @cached_property
    def colour(self) -> Array:
        """Of its cap, L*a*b*."""
        return _colour([self.track.detections[k] for k in range(self.begin, self.end)])

    def _motion(self, order: Sequence[int]) -> _Motion:
        times = np.array([self.track.times[k] for k in order])
        count = max(int((np.abs(times - times[0]) <= WINDOW).sum()), BIRTHS)
        return _Motion.of(times[:count], [self.track.detections[k] for k in order[:count]])


def rejoined(tracks: Sequence[Track], radius: float, other: float = OTHER_STONE) -> list[Track]:
    """Join the stretches in which stones are seen to the tracks of these stones.

    Parameters
    ----------
    tracks : sequence of Track
        As they were followed, each of `BIRTHS` detections or more.
    radius : float
        Of the discs, m.
    other : float
        Difference of cap colours, L*a*b* units, that says: another stone.

    Returns
    -------
    list of Track
        In order of birth.
    """
    stretches = [stretch for track in tracks for stretch in _stretches(track)]
    count = len(stretches)
    cost = np.full((count, 2 * count), MISSED)  # the second half: it does not come back
    for i, before in enumerate(stretches):
        for j, after in enumerate(stretches):
            unseen = after.track.times[after.begin] - before.track.times[before.end - 1]
            followed = before.track is after.track and before.end == after.begin
            if followed or 0 < unseen < PATIENCE:
                cost[i, j] = min(_miss(before, after, radius, other), MISSED)
            if followed and not before.last.speed + after.first.speed:
                cost[i, j] = min(cost[i, j], TAPPED)
    goes_on = {i: j for i, j in assign(cost) if cost[i, j] < MISSED}
    out = []
    for first in sorted(set(range(count)) - set(goes_on.values())):
        chain = [first]
        while chain[-1] in goes_on:
            chain.append(goes_on[chain[-1]])
        out.append(_joined([stretches[k] for k in chain]))
    return sorted(out, key=lambda track: (track.frames[0], track.detections[0].x))


def _stretches(track: Track) -> list[_Stretch]:
    """Part a track where its stone was out of sight; a glimpse stays with what it was taken for."""
    cuts = [0]
    for k in (np.flatnonzero(np.diff(track.times) > GAP) + 1).tolist():
        if min(k - cuts[-1], len(track.times) - k) >= BIRTHS:
            cuts.append(k)
    ends = pairwise([*cuts, len(track.times)])
    return [_Stretch(track, begin, end) for begin, end in ends]


def _miss(gone: _Stretch, back: _Stretch, radius: float, other: float) -> float:
    """How far two ways of stones of one colour miss each other, in variances."""
    if colour_difference(gone.colour, back.colour) > other:
        return np.inf
    before, after = gone.last, back.first
    t = np.linspace(before.t, after.t, STEPS)
    away = ((before.at(t) - after.at(t)) ** 2).sum(1)
    variance = before.variance(t, radius) + after.variance(t, radius)
    return float((away / variance).min())


def _joined(stretches: Sequence[_Stretch]) -> Track:
    """Make one track of stretches in a row."""
    whole = stretches[0].track
    if all(part.track is whole for part in stretches) and (
        stretches[0].begin == 0 and stretches[-1].end == len(whole.times)
    ):
        return whole
    out = Track()
    for part in stretches:
        out.frames += part.track.frames[part.begin : part.end]
        out.times += part.track.times[part.begin : part.end]
        out.detections.extend(part.track.detections[part.begin : part.end])
    out.colour = _colour(out.detections)
    return out


def _colour(seen: Iterable[Detection]) -> Array:
    """Of a cap, L*a*b*: of one that goes out of sight a jersey may be seen in the end."""
    colours, visible = zip(*((s.colour, s.visible) for s in seen), strict=True)
    return np.asarray(np.average(colours, axis=0, weights=np.square(visible)))
