"""Where two paths come near enough for a hit: all that may have been one, in order of time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from curlshot.physics.local_fit.breaks import FEWEST, breaks
from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import Trace

Floats = NDArray[np.float64]

REACH = 1.15
"""Distance in units of 2R up to which two discs may touch (scale errors, covers, shape)."""

TOUCHING = 1.02
"""Distance in units of 2R up to which two discs touch, but for noise."""

LITTLE = 0.25
"""Time within which a hit shows in where a stone is, s, unless six detections take longer."""

LONG = 1.0
"""Time within which it shows that a stone was hardly moved, s."""

GAP, SIDE = 2.5, 6
"""Usual times between detections that make a gap, and how many detections either side of it say how
stones went on in it."""

ONCE = 1.0
"""Time out of sight, s, in which a stone hits another but once, unless they lie in a rack."""

OUT_OF_SIGHT = 0.5
"""Time out of sight, s, after which the detections at its ends do not tell the way between them."""


def candidates(known: Mapping[str, Trace], radius: float) -> list[Meeting]:
    """Find where two paths come within reach of a contact, in order of time."""
    moving = {name for name, path in known.items() if _extent(path) > 0.25 * radius}
    paths = {name: known[name] for name in moving}
    turns = {name: breaks(p.t, p.xy, p.sd, p.lasting) for name, p in paths.items()}
    found: list[Meeting] = []
    for first, second in combinations(sorted(known), 2):
        if first in moving or second in moving:
            found += _approaches(known[first], known[second], turns, radius)
    found += _transmitted(found, known, radius)
    return in_causal_order(sorted(found, key=lambda meeting: meeting.t), known)


def _transmitted(
    meetings: Sequence[Meeting], known: Mapping[str, Trace], radius: float
) -> list[Meeting]:
    """Add candidates of stones that touch one that is hit, where there are none yet.

    An impulse is transmitted through a row of touching stones, all of which but the last may stay.
    """
    out: list[Meeting] = []
    for meeting in (every := list(meetings)):
        for stone in meeting.stones:
            for other in sorted({*known} - {*meeting.stones}):
                first, second = sorted((stone, other))
                a, b = known[first], known[second]
                t, gap = meeting.t, max(a.gap(meeting.t), b.gap(meeting.t))
                told = any(m.stones == (first, second) and abs(m.t - t) < 3 * gap for m in every)
                if told or not max(a.t[0], b.t[0]) < t < min(a.t[-1], b.t[-1]):
                    continue
                before = np.array([t - gap])
                apart = float(np.hypot(*(_at(b, before) - _at(a, before))[0]))
                noise = 3 * np.sqrt(np.mean(a.sd**2) + np.mean(b.sd**2))
                if apart < TOUCHING * 2 * radius + noise:
                    every.append(Meeting(t + 0.01 * gap, (first, second), gap))
                    out.append(every[-1])
    return out


def in_causal_order(meetings: Sequence[Meeting], known: Mapping[str, Trace]) -> list[Meeting]:
    """Order hits of about the same time by cause: each after those that drive its stones.

    Parameters
    ----------
    meetings : sequence of Meeting
        In order of time.
    known : mapping of str to Trace
    """
    times: dict[int, float] = {}
    for k in range(len(meetings)):
        if k in times:
            continue
        before = -np.inf
        for j in _chain(meetings, k, known):
            own = meetings[j]
            times.setdefault(j, own.t if own.t > before else before + 0.01 * own.looseness)
            before = times[j]
    timed = [replace(meeting, t=times[k]) for k, meeting in enumerate(meetings)]
    return sorted(timed, key=lambda meeting: meeting.t)


def _chain(meetings: Sequence[Meeting], k: int, known: Mapping[str, Trace]) -> list[int]:
    """Ranks of the meetings of about the time of meeting k that caused it, then k itself.

    Those of its stones with others that came nearer; else the shortest chain that begins with a
    pair that came nearer, in which each meeting shares a stone with the next.
    """
    last = meetings[k]
    if _closing(last, known, last.t) > 0:
        return [k]
    near: dict[tuple[str, str], int] = {}
    for j, other in enumerate(meetings):
        if abs(other.t - last.t) <= 2.5 * max(other.looseness, last.looseness):
            near.setdefault(other.stones, j)
    near.pop(last.stones, None)
    led = [j for j in near.values() if _closing(meetings[j], known, last.t) > 0]
    beside = [j for j in led if not {*meetings[j].stones}.isdisjoint(last.stones)]
    if beside:
        return [*beside, k]
    chains, reached = [[j] for j in led], {*led}
    for chain in chains:
        stones = {*meetings[chain[-1]].stones}
        if not stones.isdisjoint(last.stones):
            return [*chain, k]
        further = [j for pair, j in near.items() if j not in reached and stones & {*pair}]
        chains += [[*chain, j] for j in further]
        reached.update(further)
    return [k]


def _closing(meeting: Meeting, known: Mapping[str, Trace], time: float) -> float:
    """How much nearer, m, a pair came over a few detections before `time`; 0 if none for sure."""
    first, second = (known[stone] for stone in meeting.stones)
    step = max(first.step, second.step)
    t = time - step * np.array([8.0, 7.0, 6.0, 3.0, 2.0, 1.0])
    distance = np.hypot(*(_at(second, t) - _at(first, t)).T)
    change = float(distance[:3].mean() - distance[3:].mean())
    noise = np.sqrt(np.mean(first.sd**2) + np.mean(second.sd**2))
    return change if change > 3 * noise else min(change, 0.0)


def _extent(path: Trace) -> float:
    """Size of the region that a path's places lie in, m, but for fewer in a row than a segment has.

    However long a stone rests before and after: what it goes is no share of its places.
    """
    wide = min(2 * FEWEST - 1, (len(path.xy) + 1) // 2)
    usual = np.median(sliding_window_view(path.xy, wide, axis=0), axis=-1)
    return float(np.hypot(*np.ptp(usual, axis=0)))


def _approaches(
    a: Trace, b: Trace, turns: Mapping[str, Sequence[float]], radius: float
) -> list[Meeting]:
    start, end = max(a.t[0], b.t[0]), min(a.t[-1], b.t[-1])
    t = np.union1d(a.t, b.t)
    t = t[(t >= start) & (t <= end)]
    if len(t) < 3:
        return []
    t, apart = _through_gaps(t, _at(b, t) - _at(a, t), _hidden(a, b, t))
    distance = np.hypot(apart[:, 0], apart[:, 1])
    # Between two detections they may have come closer by what they move in that time.
    noise = 3 * np.sqrt(np.mean(a.sd**2) + np.mean(b.sd**2))
    step = np.maximum(np.hypot(*np.diff(apart, axis=0).T) - noise, 0.0)
    step = _over_gaps(a, b, t, step)
    reach = REACH * 2 * radius + 0.6 * np.maximum(np.append(step, 0.0), np.append(0.0, step))
    near = np.flatnonzero(distance < reach + noise / 3)
    # One approach lasts until they are clearly out of reach of each other.
    far = np.cumsum(distance > 1.1 * reach + noise)
    out: list[Meeting] = []
    for run in np.split(near, np.flatnonzero(np.diff(far[near])) + 1):
        if not len(run):
            continue
        low, high = t[run[0]], t[run[-1]]
        one, other = ([x for x in turns.get(p.stone, ()) if low <= x <= high] for p in (a, b))
        times = _meeting_times(t, distance, run, noise, (one, other))
        times = _at_turns_if_untold(_at_turns_if_untold(times, one, b), other, a)
        for time in times:
            if moves(a, time, radius) or moves(b, time, radius):
                gap = max(a.gap(time), b.gap(time))
                out.append(Meeting(time, (a.stone, b.stone), gap))
    return out


def _at_turns_if_untold(times: list[float], turns: Sequence[float], untold: Trace) -> list[float]:
    """Replace times while one stone's path is not known by those at which the other turned.

    When two seem closest then is chance. So it is while a stone is long out of sight, and where it
    is seen too few times before or after to show a turn of its own.
    """
    n = len(untold.t)
    for turn in turns:
        k = int(np.searchsorted(untold.t, turn))
        if not 0 < k < n:
            continue
        low, high = untold.t[k - 1], untold.t[k] + 3 * untold.step
        if untold.t[k] - untold.t[k - 1] <= OUT_OF_SIGHT:
            if FEWEST <= k <= n - FEWEST:
                continue
            low = untold.t[max(k - FEWEST, 0)] - untold.step
        times = [t for t in times if t in turns or not low < t < high] + [turn]
    return sorted({*times})


def _meeting_times(
    t: Floats,
    distance: Floats,
    run: NDArray[np.int64],
    noise: float,
    turns: tuple[Sequence[float], Sequence[float]],
) -> list[float]:
    """List the times within one stretch of nearness at which the two may have met.

    The closest approach; the first and the last moment that are as close as noise can tell, since
    one may follow the other from there, or have touched it till then; and the times at which the
    motion of both changed, since two may lie side by side for long. What is closest of a long
    touch is chance.
    """
    k = int(run[np.argmin(distance[run])])
    close = run[distance[run] < distance[k] + noise]
    step = float(np.median(np.diff(t)))
    closest = _vertex(t, distance, k)
    further = [_vertex(t, distance, int(end)) for end in (close[0], close[-1]) if end]
    times = [closest]
    if t[close[-1]] - t[close[0]] > 3 * step:
        times, further = [further[-1]], [*further[:-1], closest]
    one, other = turns
    further += [turn for turn in one if any(abs(turn - x) < 3 * step for x in other)]
    for time in further:
        if min(abs(time - x) for x in times) > 3 * step:
            times.append(time)
    return times


def moves(path: Trace, time: float, radius: float, within: float = LITTLE) -> bool:
    """Whether a stone is somewhere else soon after `time`, s, than before it."""
    k = int(np.searchsorted(path.t, time))
    few = max(6, round(within / path.step))
    before, after = path.xy[max(k - few, 0) : max(k - 1, 1)], path.xy[k + 1 : k + few]
    if not len(before) or not len(after):
        return True
    shift = float(np.hypot(*(after.mean(axis=0) - before.mean(axis=0))))
    sd = float(np.mean(path.sd)) * np.sqrt(1 / len(before) + 1 / len(after))
    return bool(shift > max(4 * sd, 0.02 * radius))


def _at(path: Trace, t: Floats) -> Floats:
    return np.column_stack([np.interp(t, path.t, path.xy[:, axis]) for axis in range(2)])


def _hidden(a: Trace, b: Trace, t: Floats) -> NDArray[np.bool_]:
    """Whether it is not seen how two stones move in the intervals between some times.

    Both are out of sight, or one is for so short a time that it is hit but once.
    """
    gaps = []
    for path in (a, b):
        k = np.clip(np.searchsorted(path.t, 0.5 * (t[1:] + t[:-1])), 1, len(path.t) - 1)
        gaps.append((path.t[k] - path.t[k - 1], GAP * path.step))
    (one, usual), (other, as_usual) = gaps
    out, also = one > usual, other > as_usual
    return (out & also) | (out & (one < ONCE)) | (also & (other < ONCE))


def _through_gaps(t: Floats, apart: Floats, hidden: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Put where ways before and after a gap cross for what lines over the gap have in it.

    A stone that hits another out of sight may be on the same side of it, and as far from it, at
    both ends of the gap.

    Parameters
    ----------
    t, apart : (n,), (n, 2) arrays
        Times, s, and places of one stone relative to the other, m.
    hidden : (n - 1,) array
        Whether the intervals between them lie in a gap.
    """
    keep, times, crossings = np.ones(len(t), bool), [], []
    ends = np.flatnonzero(np.diff(np.concatenate([[False], hidden, [False]])))
    for k, end in ends.reshape(-1, 2).tolist():
        if not 0 < k < end < len(t) - 1:
            continue
        first, last = max(k - SIDE, 0), min(end + SIDE, len(t) - 1)
        before = (apart[k] - apart[first]) / (t[k] - t[first])
        after = (apart[last] - apart[end]) / (t[last] - t[end])
        turn = after - before
        since = (apart[k] - apart[end] + (t[end] - t[k]) * after) @ turn
        time = t[k] + since / max(turn @ turn, 1e-12)
        if t[k] < time < t[end]:
            times.append(time)
            crossings.append(apart[k] + (time - t[k]) * before)
            keep[k + 1 : end] = False
    if not times:
        return t, apart
    ranks = np.searchsorted(t[keep], times)
    return np.insert(t[keep], ranks, times), np.insert(apart[keep], ranks, crossings, axis=0)


def _over_gaps(a: Trace, b: Trace, t: Floats, step: Floats) -> Floats:
    """Relative movement over the whole of the gap that each interval lies in."""
    out = step.copy()
    middle = 0.5 * (t[1:] + t[:-1])
    for path in (a, b):
        k = np.clip(np.searchsorted(path.t, middle), 1, len(path.t) - 1)
        ratio = (path.t[k] - path.t[k - 1]) / (t[1:] - t[:-1])
        out = np.maximum(out, step * ratio)
    return out


def _vertex(t: Floats, distance: Floats, k: int) -> float:
    """Time of closest approach from lines through the two samples on either side of it."""
    if 2 <= k < len(t) - 2:
        for low in (k, k + 1):  # the last sample before the meeting is k - 1 or k
            down = (distance[low - 1] - distance[low - 2]) / (t[low - 1] - t[low - 2])
            up = (distance[low + 1] - distance[low]) / (t[low + 1] - t[low])
            if down < 0 < up:
                rise = distance[low] - up * t[low] - distance[low - 1] + down * t[low - 1]
                cross = rise / (down - up)
                if t[low - 1] <= cross <= t[low]:
                    return float(cross)
    return float(t[k])
