"""Which detection is which stone: association over time by gating and global assignment.

Two discs are never nearer than two radii, so between frames a stone is told from its
neighbours by place alone as long as it moves by less than about a radius more or less than
expected; a hit changes its course by no more than that from one frame to the next. Out of
sight a moving stone is expected to glide on and come to rest; one at rest stays; where two
would meet, a hit is expected.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import hypot, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from curlshot.vision.association.assign import assign
from curlshot.vision.association.hits import MOTION_TOLD, struck
from curlshot.vision.association.lead import DECELERATION, coloured
from curlshot.vision.association.rows import Rows
from curlshot.vision.detection.appearance import OTHER_STONE, colour_differences
from curlshot.vision.detection.detection import Detection

Array = NDArray[np.float64]

Pair = tuple[float, float]

DETECTION_SD = 0.004
"""What detections err by beside what they say, radii: half a millimetre."""

ACCELERATION_NOISE = 2.0
"""Root of the spectral density of the acceleration, taken for white noise, radii/s^1.5."""

ANY_SPEED = 10.0
"""Standard deviation of a speed of which nothing is known, radii/s."""

GATE = 25.0
"""Squared normalised innovation beyond which a stone has been hit: its speed may be any."""

OPEN = 0.7
"""Share of a stone that must be seen for nothing to cover it: what bends over it covers more."""

_FORBIDDEN = 1e6
"""Cost of a pair that may not be: more than all others together."""


REACH, GROWTH, MOST_REACH = 1.25, 2.0, 3.5
"""Largest distance from where a stone seen in the frame before is expected, how much that grows per
second out of sight, and what it grows to at most, all in radii."""

PATIENCE = 3.0
"""Seconds for which a moving stone is waited for."""

BIRTHS = 5
"""Detections that make a track."""

BRIEF = 0.5
"""A track no longer than this, s, must show more in the open: shoulders look like a stone for a few
frames where a person turns."""


@dataclass
class Track:
    """One stone's detections, each with the index of its frame in the clip.

    Attributes
    ----------
    frames, times : list
        Frame numbers and times, s, of the detections.
    detections : Rows
    colour : ndarray, shape (3,)
        Running mean of the cap's colour, L*a*b*.

    Beside them it has the state of a Kalman filter of constant velocity. Its covariance is the same
    for both axes: of place, of place with velocity, of velocity.
    """

    frames: list[int] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    detections: Rows = field(default_factory=Rows)
    colour: Array = field(default_factory=lambda: np.zeros(3))
    _place: Pair = (0.0, 0.0)
    _velocity: Pair = (0.0, 0.0)
    _covariance: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def speed(self) -> float:
        """Speed at the last detection, m/s; 0 where it cannot be told from 0."""
        speed = hypot(*self._velocity)
        return speed if speed > 3 * sqrt(self._covariance[2]) else 0.0

    def expected(self, t: float) -> Pair:
        """Place at time t if nothing hits it: it glides on, slows down and stops."""
        speed = self.speed
        if speed == 0:
            return self._place
        wait = min(t - self.times[-1], speed / DECELERATION)
        path = wait - 0.5 * DECELERATION * wait**2 / speed
        (x, y), (vx, vy) = self._place, self._velocity
        return x + vx * path, y + vy * path

    def add(self, frame: int, t: float, detection: Detection, radius: float) -> None:
        """Take in a detection."""
        x, y = detection.x, detection.y
        noise = detection.sd_x * detection.sd_y + (DETECTION_SD * radius) ** 2
        if not self.times:
            self._place, self._covariance = (x, y), (noise, 0.0, (ANY_SPEED * radius) ** 2)
            self.colour = np.array(detection.colour, float)
        else:
            step = t - self.times[-1]
            self._predict(step, radius)
            self._update(x, y, noise, step, radius)
            self.colour = coloured(self.colour, detection)
        self.frames.append(frame)
        self.times.append(t)
        self.detections.append(detection)

    def _predict(self, step: float, radius: float) -> None:
        """Predict the state so many seconds ahead."""
        (x, y), (vx, vy), (p00, p01, p11) = self._place, self._velocity, self._covariance
        q = (ACCELERATION_NOISE * radius) ** 2 * step
        self._place = x + vx * step, y + vy * step
        self._covariance = (
            p00 + (step * (2 * p01 + step * p11) + q * step**2 / 3),
            p01 + (step * p11 + q * step / 2),
            p11 + q,
        )

    def _update(self, x: float, y: float, noise: float, step: float, radius: float) -> None:
        """Update the state by a detection at x, y with the variance `noise` per axis."""
        (predicted_x, predicted_y), (vx, vy) = self._place, self._velocity
        p00, p01, p11 = self._covariance
        innovation_x, innovation_y = x - predicted_x, y - predicted_y
        if innovation_x**2 + innovation_y**2 > GATE * (p00 + noise):
            any_speed = (ANY_SPEED * radius) ** 2
            p00 += any_speed * step**2
            p01 += any_speed * step
            p11 += any_speed
        gain, rate = p00 / (p00 + noise), p01 / (p00 + noise)
        self._place = predicted_x + gain * innovation_x, predicted_y + gain * innovation_y
        self._velocity = vx + rate * innovation_x, vy + rate * innovation_y
        self._covariance = p00 - gain * p00, p01 - gain * p01, p11 - rate * p01


def follow(
    frames: Iterable[tuple[int, float, Sequence[Detection]]],
    radius: float,
    least_score: float = 0.0,
    least_open: float = 0.0,
    other: float = OTHER_STONE,
) -> list[Track]:
    """Join the detections of a clip to tracks.

    Parameters
    ----------
    frames : iterable of (frame, t, detections)
        In order of time; read once.
    radius : float
        Of the discs, m.
    least_score : float
        Evidence that the better part of a track's detections must show.
    least_open : float
        The same for a track no longer than `BRIEF` of what nothing covers.
    other : float
        Difference of cap colours, L*a*b* units, that says: another stone.

    Returns
    -------
    list of Track
        Those with enough detections to be a stone, in order of birth.
    """
    tracks: list[Track] = []
    closed: list[Track] = []
    count, begin, t, step = 0, inf, -inf, inf
    for frame, now, detections in frames:
        step, t = min(step, now - t), now
        count, begin = count + 1, min(begin, t)
        lost = [i for i, track in enumerate(tracks) if _given_up(track, t, step)]
        for index in reversed(lost):
            closed.append(tracks.pop(index))
        taken = _assign(tracks, t, detections, radius, other)
        for column, detection in enumerate(detections):
            if column in taken:
                taken[column].add(frame, t, detection, radius)
            else:
                track = Track()
                track.add(frame, t, detection, radius)
                tracks.append(track)
    births = min(BIRTHS, (count + 1) // 2)
    if t - begin < 2 * BRIEF:  # all tracks are brief
        least_open = least_score
    stones = [
        track
        for track in closed + tracks
        if len(track.frames) >= births and _convincing(track, least_score, least_open)
    ]
    return sorted(
        (track for track in stones if not any(_beneath(track, o, radius) for o in stones)),
        key=lambda track: (track.frames[0], track.detections[0].x),
    )


def _beneath(track: Track, other: Track, radius: float) -> bool:
    """Whether a track lies where another is before and after: centres are never so near.

    It is that stone, half covered by something of another colour.
    """
    if not other.times[0] < track.times[0] <= track.times[-1] < other.times[-1]:
        return False
    here, there = (one.detections.columns("x", "y") for one in (track, other))
    away = [np.interp(track.times, other.times, there[i]) - here[i] for i in (0, 1)]
    return bool((np.hypot(*away) < radius).all())


def _convincing(track: Track, least_score: float, least_open: float) -> bool:
    """Say whether the better quarter of what was measured shows enough; in the open, half of it.

    What looks unchanged shows nothing more. What covers a stone now and then hides its evidence,
    but a disc of paint shows some of granite while a person stands beside it.
    """
    score, visible, measured = track.detections.columns("score", "visible", "measured")
    if not measured.any():
        return False
    in_the_open = np.median(visible) > OPEN
    shown = float(np.percentile(score[measured > 0], 50 if in_the_open else 75))
    brief = track.times[-1] - track.times[0] < BRIEF
    return shown >= (least_open if brief and in_the_open else least_score)


def _given_up(track: Track, t: float, step: float) -> bool:
    """Say whether a track ended by time t; pictures are a `step` apart or more, s."""
    wait = t - track.times[-1]
    if len(track.frames) < BIRTHS:
        return wait > max(0.25 * PATIENCE, 1.5 * step)
    return track.speed > 0 and wait > PATIENCE


def _assign(
    tracks: Sequence[Track],
    t: float,
    detections: Sequence[Detection],
    radius: float,
    other: float,
) -> dict[int, Track]:
    """Return the track that each detection continues, by its index."""
    if not tracks or not detections:
        return {}
    seen = np.array([(s.x, s.y) for s in detections])
    last = np.array([track._place for track in tracks])
    since = np.array([track.times[-1] for track in tracks])
    ways = np.array([track._velocity if track.speed > 0 else (0.0, 0.0) for track in tracks])
    told = np.array([len(track.times) >= MOTION_TOLD for track in tracks])
    met = struck(last, ways, since, told, t, radius)
    waits = t - since
    reach = np.minimum(REACH + GROWTH * waits, MOST_REACH)[:, None] * radius
    expected = np.array(
        [met[row][0] if row in met else track.expected(t) for row, track in enumerate(tracks)]
    )
    away, near = (
        np.hypot(*(seen - places[:, None]).transpose(2, 0, 1)) for places in (expected, last)
    )
    # A stone that has been hit a moment ago is still near where it was.
    distance = np.minimum(away / reach, near / reach + 0.1)
    unlike = colour_differences(
        np.array([track.colour for track in tracks]), np.array([s.colour for s in detections])
    )
    # What is seen of one that somebody covers may be a jersey.
    shown = np.minimum(np.array([s.visible for s in detections]) / OPEN, 1.0)
    unlike = unlike * shown**2
    # Young tracks yield to old ones.
    youth = np.array([0.5 if len(track.frames) < BIRTHS else 0.0 for track in tracks])
    value = distance**2 + (0.5 * unlike / other) ** 2 + youth[:, None]
    cost = np.where((distance < 1) & (unlike < other), value, _FORBIDDEN)
    return {column: tracks[row] for row, column in _paired(cost)}


def _paired(cost: Array) -> list[tuple[int, int]]:
    """Rows and columns that together cost least, without the forbidden pairs."""
    allowed = cost < _FORBIDDEN
    if allowed.sum(0).max() < 2 and allowed.sum(1).max() < 2:  # no two claim the same
        return [(int(row), int(column)) for row, column in np.argwhere(allowed)]
    return [pair for pair in assign(cost) if allowed[pair]]
