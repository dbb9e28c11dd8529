"""Where two stones meet: hits told from near misses, timed to a fraction of a frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from data.tracks import Table
from physics.fit import fit_shot
from physics.segments import Piece, breaks, cut
from physics.shot_fit import Deceleration, Encounter, Meeting, ShotFit
from physics.traces import Trace, traces

Floats = NDArray[np.float64]

REACH = 1.15
"""Distance in units of 2R up to which two discs may touch (scale errors, covers, shape)."""

SIGNIFICANT = 5.0
"""Normalised impulse below which two stones have passed each other."""

MOST_PUSH = 3.0
"""Most that a hit can change the relative speed of two stones, in closing speeds (1 + e)."""

LITTLE = 0.25
"""Time within which a hit shows in where a stone is, s, unless six sightings take longer."""

SHARE = 0.15
"""Smallest part of the other's change of velocity that a stone must show in a hit."""


@dataclass(frozen=True)
class Contact:
    """A hit of two stones.

    Attributes
    ----------
    t, stderr_t : float
        Time of the contact and its standard error, s.
    stones : tuple of two str
        The one that was faster before the hit comes first.
    normal : tuple of two float
        Unit vector from the first stone's centre to the second's.
    """

    t: float
    stderr_t: float
    stones: tuple[str, str]
    normal: tuple[float, float]


def find_contacts(sightings: Table, radius: float) -> tuple[Contact, ...]:
    """Find the hits between the stones of a table of sightings.

    Every approach of two stones to about 2R is a candidate. All are fitted at once as hits,
    and the one whose impulse is least significant is struck off until all that are left
    changed the motion of both their stones.

    Parameters
    ----------
    sightings : Table
        `data.tracks.SIGHTING_COLUMNS`.
    radius : float
        Of the discs, m.

    Returns
    -------
    tuple of Contact
        In order of time.
    """
    known = traces(sightings)
    meetings = candidates(known, radius)
    cuts: dict[str, list[Piece]] = {}
    while meetings:
        pieces, cuts = cut_all(known, meetings, radius, cuts)
        fit = fit_shot(known, pieces, meetings, radius, deceleration=Deceleration(0.0, 0.5, 0.5))
        evidence = [_evidence(fit, k, radius) for k in range(len(meetings))]
        weakest = int(np.argmin(evidence))
        if evidence[weakest] >= SIGNIFICANT:
            return _contacts(fit)
        struck = meetings[weakest]
        meetings = [meeting for meeting in meetings if meeting is not struck]
        cuts = {name: run for name, run in cuts.items() if name not in struck.stones}
        cuts = _renumbered(cuts, weakest)
    return ()


def _renumbered(cuts: Mapping[str, list[Piece]], gone: int) -> dict[str, list[Piece]]:
    """Close the gap that a struck-off meeting leaves in the ranks."""

    def rank(k: int | None) -> int | None:
        return k - 1 if k is not None and k > gone else k

    return {
        name: [replace(p, opens=rank(p.opens), closes=rank(p.closes)) for p in run]
        for name, run in cuts.items()
    }


def cut_all(
    known: Mapping[str, Trace],
    meetings: Sequence[Meeting | Contact],
    radius: float,
    done: Mapping[str, list[Piece]] | None = None,
) -> tuple[list[Piece], dict[str, list[Piece]]]:
    """Cut the paths of all stones at their meetings; `done` holds those cut before."""
    cuts = dict(done or {})
    for name, path in known.items():
        if name not in cuts:
            hits = [(k, m.t) for k, m in enumerate(meetings) if name in m.stones]
            cuts[name] = cut(path, sorted(hits, key=lambda hit: hit[1]), radius)
    return [piece for name in known for piece in cuts[name]], cuts


def candidates(known: Mapping[str, Trace], radius: float) -> list[Meeting]:
    """Find where two paths come within reach of a contact, in order of time."""
    moving = {name for name, path in known.items() if _extent(path) > 0.25 * radius}
    turns = {name: breaks(known[name].t, known[name].xy, known[name].sd) for name in moving}
    found: list[Meeting] = []
    for first, second in combinations(sorted(known), 2):
        if first in moving or second in moving:
            found += _approaches(known[first], known[second], turns, radius)
    return _causal(sorted(found, key=lambda meeting: meeting.t), known)


def _causal(meetings: list[Meeting], known: Mapping[str, Trace]) -> list[Meeting]:
    """Put a hit that sets a touching pair in motion before the hit of that pair."""
    out = list(meetings)
    for i, late in enumerate(meetings):
        for j, early in enumerate(meetings[:i]):
            width = max(early.looseness, late.looseness)
            if late.t - early.t > 2.5 * width or set(early.stones).isdisjoint(late.stones):
                continue
            if _closing(late, known, early.t) > 0 >= _closing(early, known, early.t):
                out[j] = replace(early, t=late.t + 0.01 * width)
    return sorted(out, key=lambda meeting: meeting.t)


def _closing(meeting: Meeting, known: Mapping[str, Trace], time: float) -> float:
    """How much nearer, m, a pair came over a few sightings before `time`; 0 if none for sure."""
    first, second = (known[stone] for stone in meeting.stones)
    step = max(first.step, second.step)
    t = time - step * np.array([8.0, 7.0, 6.0, 3.0, 2.0, 1.0])
    distance = np.hypot(*(_at(second, t) - _at(first, t)).T)
    change = float(distance[:3].mean() - distance[3:].mean())
    noise = np.sqrt(np.mean(first.sd**2) + np.mean(second.sd**2))
    return change if change > 3 * noise else min(change, 0.0)


def _extent(path: Trace) -> float:
    """Size of the region that the middle 96 % of a path's places lie in, m."""
    low, high = np.quantile(path.xy, [0.02, 0.98], axis=0)
    return float(np.hypot(*(high - low)))


def _approaches(
    a: Trace, b: Trace, turns: Mapping[str, Sequence[float]], radius: float
) -> list[Meeting]:
    start, end = max(a.t[0], b.t[0]), min(a.t[-1], b.t[-1])
    t = np.union1d(a.t, b.t)
    t = t[(t >= start) & (t <= end)]
    if len(t) < 3:
        return []
    apart = _at(b, t) - _at(a, t)
    distance = np.hypot(apart[:, 0], apart[:, 1])
    # Between two sightings they may have come closer by what they move in that time.
    noise = 3 * np.sqrt(np.mean(a.sd**2) + np.mean(b.sd**2))
    step = np.maximum(np.hypot(*np.diff(apart, axis=0).T) - noise, 0.0)
    step = _over_gaps(a, b, t, step)
    reach = REACH * 2 * radius + 0.6 * np.maximum(np.append(step, 0.0), np.append(0.0, step))
    near = np.flatnonzero(distance < reach + noise / 3)
    # One approach lasts until they are clearly out of reach of each other.
    far = np.cumsum(distance > 1.1 * reach + noise)
    looseness = max(a.step, b.step)
    out: list[Meeting] = []
    for run in np.split(near, np.flatnonzero(np.diff(far[near])) + 1):
        if not len(run):
            continue
        both = turns.get(a.stone, ()), turns.get(b.stone, ())
        times = _meeting_times(t, distance, run, noise, both)
        for time in times:
            if _moves(a, time, radius) or _moves(b, time, radius):
                gap = max(_gap(a, time), _gap(b, time), looseness)
                out.append(Meeting(time, (a.stone, b.stone), gap))
    return out


def _meeting_times(
    t: Floats,
    distance: Floats,
    run: NDArray[np.int64],
    noise: float,
    turns: tuple[Sequence[float], Sequence[float]],
) -> list[float]:
    """List the times within one stretch of nearness at which the two may have met.

    The closest approach; the first moment that is as close as noise can tell, since one may
    follow the other from there; and the times at which the motion of both changed, since two
    may lie side by side for long.
    """
    k = int(run[np.argmin(distance[run])])
    first = int(run[np.argmax(distance[run] < distance[k] + noise)])
    times = [_vertex(t, distance, k)]
    step = float(np.median(np.diff(t)))
    further = [] if first == 0 else [_vertex(t, distance, first)]
    one, other = turns
    inside = [turn for turn in one if t[run[0]] <= turn <= t[run[-1]]]
    further += [turn for turn in inside if any(abs(turn - x) < 3 * step for x in other)]
    for time in further:
        if min(abs(time - x) for x in times) > 3 * step:
            times.append(time)
    return times


def _moves(path: Trace, time: float, radius: float) -> bool:
    """Whether a stone is somewhere else a little after `time` than before it."""
    k = int(np.searchsorted(path.t, time))
    few = max(6, round(LITTLE / path.step))
    before, after = path.xy[max(k - few, 0) : max(k - 1, 1)], path.xy[k + 1 : k + few]
    if not len(before) or not len(after):
        return True
    shift = float(np.hypot(*(after.mean(axis=0) - before.mean(axis=0))))
    sd = float(np.mean(path.sd)) * np.sqrt(1 / len(before) + 1 / len(after))
    return bool(shift > max(4 * sd, 0.02 * radius))


def _at(path: Trace, t: Floats) -> Floats:
    return np.column_stack([np.interp(t, path.t, path.xy[:, axis]) for axis in range(2)])


def _gap(path: Trace, time: float) -> float:
    """Time between the sightings either side of `time`."""
    k = int(np.clip(np.searchsorted(path.t, time), 1, len(path.t) - 1))
    return float(path.t[k] - path.t[k - 1])


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


def _evidence(fit: ShotFit, k: int, radius: float) -> float:
    """How many standard errors the impulse of meeting k is away from none; 0 if no hit."""

    def impulses(states: Sequence[Encounter]) -> Floats:
        state = states[0]
        change = state.after - state.before
        return 0.5 * np.asarray(change[1] - change[0])

    def along(states: Sequence[Encounter]) -> Floats:
        state = states[0]
        change = (state.after - state.before) @ state.normal
        closing = float((state.before[0] - state.before[1]) @ state.normal)
        return np.array([change[1] - change[0], -change[0], change[1], closing])

    value, cov = fit.propagate([k], impulses)
    both = float(np.sqrt(value @ np.linalg.solve(cov + 1e-12 * np.eye(2), value)))
    push, push_cov = fit.propagate([k], along)
    error = np.sqrt(np.diag(push_cov))
    state = fit.encounter(k)
    distance = float(np.hypot(*(state.places[1] - state.places[0])))
    closing = float((state.before[0] - state.before[1]) @ state.normal)
    unsure = float(push_cov[3, 3] ** 0.5)
    if push[0] < 3 * error[0] or abs(distance / (2 * radius) - 1) > REACH - 1:
        return 0.0
    if closing + 2 * unsure < push[0] / MOST_PUSH or push[0] < 0.2 * radius:
        return 0.0
    least = float(np.min(push[1:3] + 2 * error[1:3]))
    return 0.0 if least < SHARE * float(np.max(push[1:3])) else both


def _contacts(fit: ShotFit) -> tuple[Contact, ...]:
    out = []
    for k, meeting in enumerate(fit.meetings):
        state = fit.encounter(k)
        first, second = meeting.stones
        nx, ny = (float(value) for value in state.normal)
        if np.hypot(*state.before[1]) > np.hypot(*state.before[0]):
            first, second, nx, ny = second, first, -nx, -ny
        at = 6 * len(fit.pieces) + k
        stderr = float(np.sqrt(fit.cov[at, at]))
        out.append(Contact(state.t, stderr, (first, second), (nx, ny)))
    return tuple(sorted(out, key=lambda contact: contact.t))
