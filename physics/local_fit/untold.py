"""Hits that must have been and are not told: stones whose motion changes, and none is found.

Out of sight too little may be seen of a hit to tell it, and one in sight may be too soft. What is
not told then is said: which stones, when, and why.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.physics.local_fit.breaks import breaks
from curlshot.physics.local_fit.candidates import REACH, TOUCHING
from curlshot.physics.local_fit.segments import MOVED
from curlshot.physics.local_fit.solution import Meeting
from curlshot.physics.local_fit.traces import Trace
from curlshot.physics.local_fit.ways import (
    FEWEST,
    MISS,
    SLOWING,
    Gap,
    Way,
    first_way,
    gaps,
    last_way,
)

Floats = NDArray[np.float64]

SUDDEN = 0.1
"""Change of velocity (m/s) beyond its error that neither ice nor air can give a stone."""

DISPLACED = 0.03
"""How far from where it lay a stone has been moved, radii: 4 mm; light moves its edges by less."""

OFTEN = 2.5
"""How many times as much or as little as ice does something else slowed a stone."""

LOST = 3.0
"""Time out of sight, s, after which nobody knows where a moving stone is."""

AT_ONCE = 0.2
"""Time by which a hit that is told may be beside the change of motion that it made, s."""

OVERLAP = 0.85
"""Distance of two stones as one of them begins to move, in two radii, at which no discs hit."""

BESIDE, OPPOSITE = 0.1, 0.9
"""Time beside a change of motion, s, at which velocities are those before and after it; cosine from
which two changes are opposite, and along a line."""

SEVERAL = 3
"""Stones whose motion changes at one time, with none that hit them, from which on it is rather the
camera that moved, or people that move them."""

FEW = 7
"""Detections of which a median tells where a stone is."""

STEPS = 40
"""Times in a span at which it is looked how near two stones are."""

LISTED = 4
"""Changes of one stone's motion that are said one by one."""


@dataclass(frozen=True)
class _Change:
    """A change of a stone's motion that no hit explains, and between which times, s, it was."""

    stone: str
    start: float
    end: float
    goes: bool = True
    """Whether it goes then, or was only moved a little, as light and paint may seem to move it."""

    @property
    def hidden(self) -> bool:
        return self.end > self.start

    @property
    def when(self) -> str:
        """As it is said."""
        if self.hidden:
            return f"out of sight between {self.start:.2f} and {self.end:.2f} s"
        return f"at {self.end:.2f} s"


class Untold(NamedTuple):
    """What hits do not explain.

    Attributes
    ----------
    said : tuple of str
        Where stones were hit, or may have been, and no hit is told.
    changes : mapping
        Stone to the times, s, at which its motion changes, and nothing is seen that hit it.
    """

    said: tuple[str, ...]
    changes: Mapping[str, Sequence[float]]


def untold_hits(known: Mapping[str, Trace], told: Sequence[Meeting], radius: float) -> Untold:
    """Find where stones were hit, or may have been, and no hit is told.

    Parameters
    ----------
    known : mapping
        Stone to its detections.
    told : sequence of Meeting
        The hits that are told.
    radius : float
        Of the discs, m.
    """
    # Of paths marked once in a while nothing is told: what is beside a hit reaches across it.
    paths = {
        name: path
        for name, path in known.items()
        if len(path.t) >= 2 * FEWEST and path.step <= AT_ONCE
    }
    out: dict[frozenset[str], tuple[float, str]] = {}
    alone: dict[str, list[_Change]] = {}
    for change in sorted(_changes(paths, told, radius), key=lambda one: (one.end, one.stone)):
        other = _other(paths, change, told, radius)
        if other:
            pair, seen = frozenset({change.stone, other}), _in_sight(paths[other], change.end)
            text = _said(change, other, seen)
            apart = _apart(paths, change.stone, other, change.end)
            inside = seen and not change.hidden and apart < OVERLAP * 2 * radius
            if inside and _collide(paths[change.stone], paths[other], change.end):
                text = _unfit(change.stone, other, change.when, apart, radius)
            out.setdefault(pair, (change.end, text))
        elif change.goes:
            own = alone.setdefault(change.stone, [])
            if not own or change.end - own[-1].end > AT_ONCE:
                own.append(change)
    beyond, alone = _out_of_reach(paths, alone, radius)
    for pair, time, text in (
        *beyond,
        *_lost_and_found(paths, told, radius),
        *_touching(paths, told, radius),
    ):
        out.setdefault(pair, (time, text))
    times = {name: [change.end for change in changes] for name, changes in alone.items()}
    together, alone = _together(alone)
    lone = [(changes[0].end, _said_alone(name, changes)) for name, changes in alone.items()]
    return Untold(tuple(text for _, text in sorted([*together, *lone, *out.values()])), times)


def _said(change: _Change, other: str, seen: bool) -> str:
    name = change.stone
    if change.hidden:
        first, second = sorted((name, other))
        return (
            f"{first} and {second} apparently hit each other {change.when}: too little is visible"
            " to measure that hit and its e"
        )
    if seen:
        return (
            f"{name} moved when {other} came close {change.when}: the hit is too soft, or visible"
            " too briefly, to measure"
        )
    return (
        f"{other}, out of sight, apparently hit {name} {change.when}: too little is visible to"
        " measure that hit and its e"
    )


def _unfit(first: str, second: str, when: str, apart: float, radius: float) -> str:
    """Say that two stones hit each other where discs of this radius do not touch."""
    return (
        f"the velocities of {first} and {second} change {when} as if they hit each other, but"
        f" {apart:.2g} m apart, where two radii are {2 * radius:.3g} m: check scale, unit and"
        " radius"
    )


def _said_alone(name: str, changes: Sequence[_Change]) -> str:
    """Say where the motion of one stone changes, and nothing is seen that hit it."""
    when = [change.when for change in changes]
    if len(when) > LISTED:
        return (
            f"the velocity of {name} changes {len(when)} times between {changes[0].start:.2f} and"
            f" {changes[-1].end:.2f} s without a visible stone that hit it"
        )
    times = " and ".join(filter(None, (", ".join(when[:-1]), when[-1])))
    if all(change.hidden for change in changes):
        what = "that hit and its e are unknown" if len(when) == 1 else "these hits are unknown"
        return f"something hit {name} {times}: {what}"
    return f"the velocity of {name} changes {times} without a visible stone that hit it"


def _out_of_reach(
    paths: Mapping[str, Trace], alone: Mapping[str, Sequence[_Change]], radius: float
) -> tuple[list[tuple[frozenset[str], float, str]], dict[str, list[_Change]]]:
    """Pairs that collide, by their motion, where discs of this radius do not touch.

    Second the changes of single stones that are left.
    """
    left = {name: list(changes) for name, changes in alone.items()}
    pairs = []
    for first, second in combinations(sorted(alone), 2):
        for one in [change for change in left[first] if not change.hidden]:
            same = [
                two for two in left[second] if abs(two.end - one.end) < AT_ONCE and not two.hidden
            ]
            time = 0.5 * (one.end + same[0].end) if same else one.end
            if same and _collide(paths[first], paths[second], time):
                apart = _apart(paths, first, second, time)
                if not np.isfinite(apart):
                    continue
                left[first].remove(one)
                left[second].remove(same[0])
                text = _unfit(first, second, one.when, apart, radius)
                pairs.append((frozenset({first, second}), one.end, text))
    return pairs, {name: changes for name, changes in left.items() if changes}


def _together(
    alone: Mapping[str, Sequence[_Change]],
) -> tuple[list[tuple[float, str]], dict[str, list[_Change]]]:
    """Say changes in sight of several stones at one time at once; second those that are left."""
    seen = sorted((c for own in alone.values() for c in own if not c.hidden), key=lambda c: c.end)
    said, told = [], set[_Change]()
    for first in seen:
        same = {c.stone: c for c in seen if 0 <= c.end - first.end < AT_ONCE and c not in told}
        if first in told or len(same) < SEVERAL:
            continue
        told.update(same.values())
        *names, last = sorted(same)
        text = (
            f"the velocities of {', '.join(names)} and {last} change together {first.when}"
            " without a visible stone that hit them: did the camera move, or did people move the"
            " stones?"
        )
        said.append((first.end, text))
    left = {name: [c for c in own if c not in told] for name, own in alone.items()}
    return said, {name: own for name, own in left.items() if own}


def _changes(
    paths: Mapping[str, Trace], told: Sequence[Meeting], radius: float
) -> Iterator[_Change]:
    """Find changes of motion that no hit explains."""
    for name, path in paths.items():
        hits = [meeting.t for meeting in told if name in meeting.stones]
        hidden = list(gaps(path))
        for gap in hidden:
            known = any(gap.before.t - AT_ONCE < t < gap.after.t + AT_ONCE for t in hits)
            if not known and _changed(gap, radius):
                yield _Change(name, gap.before.t, gap.after.t)
        left = _leaves(path, radius)
        seen = [] if left is None or any(t < left[0] + AT_ONCE for t in hits) else [left]
        seen += [(t, True) for t in _turns(path) if all(abs(t - hit) > AT_ONCE for hit in hits)]
        for t, goes in seen:
            if not any(gap.before.t <= t <= gap.after.t for gap in hidden):
                yield _Change(name, t, t, goes)


def _changed(gap: Gap, radius: float) -> bool:
    """Whether something else than ice changed the motion of a stone while it was out of sight."""
    before, after = gap.before, gap.after
    shift = after.place - before.place
    sd = float(np.hypot(before.sd_place, after.sd_place))
    if not before.speed:
        return float(np.hypot(*shift)) > DISPLACED * radius + MISS * sd
    along = before.velocity / before.speed
    went, aside = float(shift @ along), abs(float(shift[0] * along[1] - shift[1] * along[0]))
    wait = after.t - before.t
    off = MISS * float(np.hypot(sd, before.sd_speed * wait)) + 0.1 * abs(went) + DISPLACED * radius
    if aside > off:
        return True
    if not after.speed:
        # Between the shortest and the longest way that ice lets it go until it rests, or is seen.
        ways = [before.speed**2 / (2 * slowing) for slowing in (SLOWING * OFTEN, SLOWING / OFTEN)]
        return not ways[0] - off < went < ways[1] + off
    slowed = (before.speed - float(after.velocity @ along)) / wait
    sd_slowed = MISS * float(np.hypot(before.sd_speed, after.sd_speed)) / wait
    turned = abs(float(after.velocity[0] * along[1] - after.velocity[1] * along[0]))
    return bool(
        turned > SUDDEN + MISS * float(np.hypot(before.sd_speed, after.sd_speed))
        # Discs on air are hardly slowed at all, but none speeds up.
        or not -sd_slowed < slowed < OFTEN * SLOWING + sd_slowed
    )


def _turns(path: Trace) -> Iterator[float]:
    """Give the times, s, at which the velocity of a stone that moves changes at once in sight."""
    for t in breaks(path.t, path.xy, path.sd, path.lasting):
        k = int(np.searchsorted(path.t, t))
        if not FEWEST <= k <= len(path.t) - FEWEST:
            continue
        before, after = last_way(path, k - 1), first_way(path, k)
        change = float(np.hypot(*(after.velocity - before.velocity)))
        sd = float(np.hypot(before.sd_speed, after.sd_speed))
        if before.speed and change > SUDDEN + MISS * sd:
            yield t


def _leaves(path: Trace, radius: float) -> tuple[float, bool] | None:
    """Time, s, at which a stone that rested first leaves its place, and whether it goes then."""
    start = first_way(path, 0)
    if start.speed:
        return None
    off, least, t = _away(path, start.place, radius)
    beyond = off > least
    if not beyond[-1] or beyond.all():
        return None
    left = float(t[len(off) - int(np.argmin(beyond[::-1]))])
    k = min(int(np.searchsorted(path.t, left)), len(path.t) - FEWEST)
    elsewhere = off[-1] > least + MOVED * radius
    return left, bool(elsewhere or first_way(path, k).speed > 0)


def _away(path: Trace, place: Floats, radius: float) -> tuple[Floats, float, Floats]:
    """Tell how far a stone is from a place, by running medians of a few detections.

    Returns
    -------
    off : (m,) array
        Distance of each median, m.
    least : float
        Distance beyond which the stone is not at the place, m.
    t : (m,) array
        Times of the medians, s.
    """
    windows = np.lib.stride_tricks.sliding_window_view(path.xy, FEW, axis=0)
    off = np.hypot(*(np.median(windows, axis=-1) - place).T)
    # A median scatters 1.25 times as a mean does; the place itself is no better known.
    sd = 1.25 * float(np.mean(path.sd)) * np.sqrt(1 / FEW + 1 / FEWEST)
    return off, DISPLACED * radius + MISS * sd, path.t[FEW // 2 : len(path.t) - (FEW - 1) // 2]


def _other(
    paths: Mapping[str, Trace], change: _Change, told: Sequence[Meeting], radius: float
) -> str | None:
    """Return the stone that comes nearest to one at a change of its motion, None if none does.

    One that has just hit it, as is told, was near it for that.
    """
    margin = 0.0 if change.hidden else 2 * AT_ONCE
    t = np.linspace(change.start - margin, change.end, STEPS)
    met = {
        stone
        for hit in told
        if change.stone in hit.stones and t[0] - AT_ONCE < hit.t < t[-1]
        for stone in hit.stones
    }
    own = [*_places(paths[change.stone], t)]
    nearest: tuple[float, str] | None = None
    for name, path in paths.items():
        if name in met | {change.stone} or _stays(path, float(t[0]), float(t[-1]), radius):
            continue
        for place, sd in _places(path, t):
            for here, sd_here in own:
                noise = np.minimum(3 * np.hypot(sd, sd_here), radius)
                near = float(np.nanmin(np.hypot(*(place - here).T) - noise, initial=np.inf))
                if near < REACH * 2 * radius and (nearest is None or near < nearest[0]):
                    nearest = near, name
    return None if nearest is None else nearest[1]


def _in_sight(path: Trace, time: float) -> bool:
    """Whether a stone is seen about a time, s."""
    return bool(path.t[0] < time < path.t[-1] and path.gap(time) < AT_ONCE)


def _stays(path: Trace, start: float, end: float, radius: float) -> bool:
    """Whether a stone lies where it lay after a span as before it."""
    k = int(np.searchsorted(path.t, start)) - 1
    j = int(np.searchsorted(path.t, end + AT_ONCE))
    if k < FEWEST or j > len(path.t) - FEWEST:
        return False
    before, after = last_way(path, k), first_way(path, j)
    shift = float(np.hypot(*(after.place - before.place)))
    sd = float(np.hypot(before.sd_place, after.sd_place))
    return not before.speed and shift < DISPLACED * radius + MISS * sd


def _places(path: Trace, t: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Where a stone may be at times, (n, 2) m, and how sure that is; not a number if unknown."""
    k = np.clip(np.searchsorted(path.t, t), 1, len(path.t) - 1)
    seen = (t >= path.t[0]) & (t <= path.t[-1]) & (path.t[k] - path.t[k - 1] < AT_ONCE)
    line = np.column_stack([np.interp(t, path.t, path.xy[:, axis]) for axis in range(2)])
    yield np.where(seen[:, None], line, np.nan), np.full(len(t), float(np.mean(path.sd)))
    ways: list[tuple[Way, NDArray[np.bool_]]] = []
    for gap in gaps(path, AT_ONCE):
        inside = (t >= gap.before.t) & (t <= gap.after.t)
        ways += [(gap.before, inside), (gap.after, inside)]
    ways.append((last_way(path, len(path.t) - 1), (t > path.t[-1]) & (t < path.t[-1] + LOST)))
    first = first_way(path, 0)
    if first.speed:
        ways.append((first, (t < path.t[0]) & (t > path.t[0] - LOST)))
    for way, inside in ways:
        if inside.any():
            yield np.where(inside[:, None], way.at(t), np.nan), way.sd(t)


def _apart(paths: Mapping[str, Trace], first: str, second: str, time: float) -> float:
    """Distance of two stones at a time, m; not a number where one is not seen then."""
    t = np.array([time])
    one, other = (next(_places(paths[name], t))[0][0] for name in (first, second))
    return float(np.hypot(*(other - one)))


def _collide(path: Trace, other: Trace, time: float) -> bool:
    """Whether two stones come together at a time and are driven apart, in whatever unit.

    Each gives the other what it loses, along the line of their centres.
    """
    ways = []
    for one in (path, other):
        k, j = np.searchsorted(one.t, [time - BESIDE, time + BESIDE])
        if k < FEWEST or j > len(one.t) - FEWEST:
            return False
        ways.append((last_way(one, int(k) - 1), first_way(one, int(j))))
    (before, after), (before_other, after_other) = ways
    line = before_other.at(np.array([time]))[0] - before.at(np.array([time]))[0]
    line = line / max(float(np.hypot(*line)), 1e-9)
    closing = float((before.velocity - before_other.velocity) @ line)
    change = after.velocity - before.velocity
    given = after_other.velocity - before_other.velocity
    sizes = [float(np.hypot(*each)) for each in (change, given)]
    return bool(
        closing > 0
        and min(sizes) > 0
        and change @ given < -OPPOSITE * sizes[0] * sizes[1]
        and -change @ line > OPPOSITE * sizes[0]
        and given @ line > OPPOSITE * sizes[1]
    )


def _lost_and_found(
    paths: Mapping[str, Trace], told: Sequence[Meeting], radius: float
) -> Iterator[tuple[frozenset[str], float, str]]:
    """Pairs of which one is lost and the other first seen, both moving, on ways that meet.

    If they lie in one place all the while, it is one stone under two names.
    """
    hits = [{*meeting.stones} for meeting in told]
    for lost, path in paths.items():
        last = last_way(path, len(path.t) - 1)
        for found, other in paths.items():
            first = first_way(other, 0)
            if not (last.speed and first.speed and 0 < first.t - last.t < LOST):
                continue
            if {lost, found} in hits:
                continue
            t = np.linspace(last.t, first.t, STEPS)
            noise = np.minimum(3 * np.hypot(last.sd(t), first.sd(t)), radius)
            apart = np.hypot(*(last.at(t) - first.at(t)).T)
            if apart.max() > radius and (apart - noise).min() < REACH * 2 * radius:
                yield (
                    frozenset({lost, found}),
                    first.t,
                    f"{lost} was last detected at {last.t:.2f} s and {found} first at"
                    f" {first.t:.2f} s, where their paths cross: a hit of the two, and its e, are"
                    " unknown",
                )


def _touching(
    paths: Mapping[str, Trace], told: Sequence[Meeting], radius: float
) -> Iterator[tuple[frozenset[str], float, str]]:
    """Stones that come to rest touching another one without a hit that is told."""
    for name, path in paths.items():
        stop = _stops(path, radius)
        if stop is None:
            continue
        end = last_way(path, len(path.t) - 1)
        for other, lying in paths.items():
            there = last_way(lying, len(lying.t) - 1)
            if other == name or there.speed or abs(there.t - end.t) > LOST:
                continue
            pair = frozenset({name, other})
            if any(pair == {*meeting.stones} for meeting in told):
                continue
            later = _stops(lying, radius)
            if later is not None and later > stop:
                continue
            apart = float(np.hypot(*(end.place - there.place)))
            noise = 3 * float(np.hypot(end.sd_place, there.sd_place))
            if apart < TOUCHING * 2 * radius + noise:
                yield (
                    pair,
                    stop,
                    f"{name} came to rest at, or almost at, {other} at {stop:.2f} s: a hit, if"
                    " there was one, is too soft to detect",
                )


def _stops(path: Trace, radius: float) -> float | None:
    """Time, s, from which a stone that came to where it is seen last lies there, if it does."""
    end = last_way(path, len(path.t) - 1)
    if end.speed:
        return None
    off, least, t = _away(path, end.place, radius)
    away = np.flatnonzero(off > least)
    return float(t[away[-1]]) if off[0] > least else None
