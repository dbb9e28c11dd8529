"""Cadence: pictures taken at one even rate and told at another, some of them once more.

Where 24 pictures a second are told as 30, every fifth repeats the one before, and the others are
told up to a frame early or late, more and more from one repeat to the next. With t in told frames,
picture n was taken at t = n / rate + begin and is told at the frame nearest to it, rate < 1; so
every frame at which the whole part of (t - begin + 1/2) rate grows shows a new picture, and all
others repeat. Rate and begin are those that contradict what was seen of the frames least; where
next to nothing contradicts them, each picture has the time at which it was taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAST = 4
"""Repeats that it takes: three gaps between such as come by chance are hardly ever alike. And new
pictures."""

CONTRADICTED = 0.15
"""Frames, per repeat, that may be other than the cadence has them: a flash, a stone that halts."""

UNEVEN = 0.2
"""Part of a frame by which told times may be off an even grid: containers round them."""

PAUSE = 64
"""Frames from one to the next beyond which a recording was halted: no cadence goes on across it."""

EARLY = 0.05
"""Part of a frame by which a picture must be told early or late: of pictures that are all told
twice none is."""

GOES_ON = 0.3
"""Power of the time told between two pictures with which they differ, at most. Where a cadence
spaces them it is 0; where pictures were lost and the ones before told instead, 1/2 for edges that
are far aside from one to the next, 1 for such as hardly move."""

AT_FIRST = 64
"""Frames by which the rate is told at first; each time twice as many make it sharper."""

ROUGH, FINE = 10, 50
"""Rates tried per one that comes to another picture within the frames looked at; in the end."""


class Shown(NamedTuple):
    """A frame of a clip: its number, its time, s, and whether it shows a new picture.

    `new` is None where nothing moves, or all stands still; `change` is by how much it differs from
    the picture before.
    """

    frame: int
    t: float
    new: bool | None
    change: float


@dataclass(frozen=True)
class Cadence:
    """When the pictures of a clip were taken, that are told at another rate.

    Attributes
    ----------
    rate, told : float
        At which the pictures were taken and are told, 1/s.
    times : dict of int to float
        By the frame that first shows a picture, when it was taken, s.
    repeats : dict of int to (float, int)
        Of each other frame its time, s, and the frame that it repeats.
    """

    rate: float
    told: float
    times: dict[int, float]
    repeats: dict[int, tuple[float, int]]


def cadence_of(shown: Sequence[Shown]) -> Cadence | None:
    """Tell the cadence of a clip; None where it has none, or told times are as even already."""
    if min(sum(one.new is told for one in shown) for told in (False, True)) < LEAST:
        return None
    new = np.array([bool(one.new) for one in shown])
    known = np.array([one.new is not None for one in shown])
    # One that is not known alone, while something moves, is most likely a repeat coded anew.
    known |= np.append(False, known[:-1]) & np.append(known[1:], False)
    at = _grid(np.array([one.t for one in shown]))
    if at is None:
        return None
    rate, begin = _fit(at[known], new[known])
    number = np.floor((at - begin + 0.5) * rate)
    first = np.append(True, np.diff(number) > 0)
    repeated = np.count_nonzero(known & ~new & ~first)
    if repeated < LEAST or np.count_nonzero(known & (new != first)) > CONTRADICTED * repeated:
        return None
    moved = np.array([one.change if one.new else 0.0 for one in shown])
    if _power(at[first], moved[first]) > GOES_ON:
        return None
    taken = number / rate + begin
    if np.abs(taken - at)[1:][first[1:]].max() < EARLY:
        return None
    step, start = np.polyfit(at, [one.t for one in shown], 1)
    frames = np.array([one.frame for one in shown])
    of = frames[first][np.cumsum(first) - 1]
    times = dict(zip(frames[first].tolist(), (start + step * taken[first]).tolist(), strict=True))
    again = zip(frames.tolist(), (start + step * at).tolist(), of.tolist(), strict=True)
    repeats = {frame: (t, source) for frame, t, source in again if frame != source}
    return Cadence(float(rate / step), float(1 / step), times, repeats)


def _grid(t: Floats) -> Floats | None:
    """Whole numbers of frames at which times lie, from 0 on; None if they are uneven or halt."""
    gaps = np.diff(t) / np.median(np.diff(t))
    if not gaps.max() < PAUSE:
        return None
    at = np.append(0.0, np.cumsum(np.round(gaps)))
    step, start = np.polyfit(at, t, 1)
    return at if np.abs(t - start - step * at).max() < UNEVEN * step else None


def _power(at: Floats, moved: Floats) -> float:
    """Power of the time told since the picture before by which pictures differ from it.

    `moved` is 0 where next to nothing does; one is compared with the next, that hardly goes faster.
    """
    lasts, change = np.log(np.diff(at)), np.log(np.maximum(moved[1:], 1e-3))
    more, by = np.diff(lasts), np.diff(change)
    told = (moved[1:-1] > 0) & (moved[2:] > 0) & (more != 0)
    return float(np.median(by[told] / more[told])) if told.any() else 0.0


def _fit(at: Floats, new: Flags) -> tuple[float, float]:
    """Rate, per frame, and begin, in frames, by which fewest of the frames are contradicted."""
    rate, around, begin = 0.5, 0.5, 0.0
    steps = [(min(AT_FIRST, len(at)), ROUGH)]
    while steps[-1][0] < len(at):
        steps.append((min(2 * steps[-1][0], len(at)), ROUGH))
    for count, fine in [*steps, (len(at), FINE)]:
        span = float(at[count - 1] - at[0] + 1)
        tried = np.linspace(rate - around, rate + around, round(2 * around * span * fine) + 1)
        tried = tried[(tried > 0) & (tried < 1)]
        *_, rate, begin = max(_phase(at[:count], new[:count], one) for one in tried.tolist())
        around = 1 / span
    return rate, begin


def _phase(at: Floats, new: Flags, rate: float) -> tuple[int, float, float, float]:
    """How many frames a rate explains at best, how wide the begin may vary; rate and begin.

    A frame shows a new picture if (at - begin + 1/2) rate is less than `rate` above a whole
    number: on a circle of such numbers, new ones lie in an arc as long as the rate, whose best
    place is sought.
    """
    turns = at * rate % 1
    sign = np.where(new, 1, -1)
    # As the arc is turned on, its end takes in one point after the other, its begin lets them go.
    ends = np.concatenate([turns, (turns - rate) % 1])
    order = np.argsort(ends)
    inside = sign[turns < rate].sum() + np.cumsum(np.concatenate([-sign, sign])[order])
    room = np.diff(ends[order], append=ends[order[0]] + 1)
    best = np.flatnonzero((room > 1e-9) & (inside == inside[room > 1e-9].max()))
    best = best[room[best].argmax()]
    arc = ends[order[best]] + room[best] / 2
    return int(inside[best]), round(float(room[best]), 9), rate, float(arc / rate + 0.5)
