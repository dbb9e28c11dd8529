"""Telecine: frames that were taken at one even rate and are shown at another, some of them twice.

Where 24 frames a second are shown as 30, every fifth repeats the one before. The others are shown
up to a frame early or late, more and more from one duplicate to the next. With t in shown frames,
frame n was taken at t = n / rate + begin and is shown nearest to that time, rate < 1. So a shown
frame is new where the whole part of (t - begin + 1/2) rate grows; all others are duplicates. Rate
and begin are those that contradict the fewest shown frames. Where they contradict very few, each
new frame gets the time at which it was taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.data.measurement import Duplicate

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEAST = 4
"""Fewest duplicates, and fewest new frames: three gaps by chance are rarely equal."""

CONTRADICTED = 0.15
"""Most frames that contradict the conversion, per duplicate: a flash, a stone that halts."""

UNEVEN = 0.2
"""Most that times may be off an even grid, in frames: containers round them."""

PAUSE = 64
"""Longest gap, in frames: beyond it the recording was halted, and no conversion goes on."""

EARLY = 0.05
"""Least that a frame must be shown early or late, in frames: where all are shown twice none is."""

GOES_ON = 0.3
"""Largest power of the time between two frames by which they differ. It is 0 for a conversion,
which spaces new frames evenly. Where frames were lost and the one before is shown instead, it is
1/2 for edges that move far, 1 for edges that barely move."""

AT_FIRST = 64
"""Frames by which the rate is first estimated; each time twice as many make it sharper."""

ROUGH, FINE = 10, 50
"""Rates tried per rate that comes to another frame within those looked at; in the end."""


class Shown(NamedTuple):
    """A frame of a clip: its number, its time, s, and whether it is new.

    `new` is None where nothing moves; `change` is by how much it differs from the frame before.
    """

    frame: int
    t: float
    new: bool | None
    change: float


@dataclass(frozen=True)
class Telecine:
    """When the frames of a clip were taken that are shown at another rate.

    Attributes
    ----------
    rate, shown_rate : float
        At which frames were taken and are shown, 1/s.
    times : dict of int to float
        By number of each new frame, when it was taken, s.
    duplicates : dict of int to Duplicate
        All other frames.
    """

    rate: float
    shown_rate: float
    times: dict[int, float]
    duplicates: dict[int, Duplicate]


def find_telecine(shown: Sequence[Shown]) -> Telecine | None:
    """Find the conversion of a clip; None where there is none, or its times are as even already."""
    if min(sum(one.new is new for one in shown) for new in (False, True)) < LEAST:
        return None
    new = np.array([bool(one.new) for one in shown])
    known = np.array([one.new is not None for one in shown])
    # A single unknown one, while something moves, is most likely a duplicate that was coded again.
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
    duplicates = {frame: Duplicate(t, source) for frame, t, source in again if frame != source}
    return Telecine(float(rate / step), float(1 / step), times, duplicates)


def _grid(t: Floats) -> Floats | None:
    """Return the whole numbers of frames at which times lie; None if they are uneven or halt."""
    gaps = np.diff(t) / np.median(np.diff(t))
    if not gaps.max() < PAUSE:
        return None
    at = np.append(0.0, np.cumsum(np.round(gaps)))
    step, start = np.polyfit(at, t, 1)
    return at if np.abs(t - start - step * at).max() < UNEVEN * step else None


def _power(at: Floats, moved: Floats) -> float:
    """Return the power of the time since the frame before by which frames differ from it.

    `moved` is 0 where next to nothing does. Each is compared with the next, which moves as fast.
    """
    lasts, change = np.log(np.diff(at)), np.log(np.maximum(moved[1:], 1e-3))
    more, by = np.diff(lasts), np.diff(change)
    known = (moved[1:-1] > 0) & (moved[2:] > 0) & (more != 0)
    return float(np.median(by[known] / more[known])) if known.any() else 0.0


def _fit(at: Floats, new: Flags) -> tuple[float, float]:
    """Return rate, per frame, and begin, in frames, that contradict the fewest frames."""
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
    """Return how many frames a rate explains at best, the width of its begin, rate and begin.

    A frame is new if (at - begin + 1/2) rate is less than `rate` above a whole
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
