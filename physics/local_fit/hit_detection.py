"""Where two stones meet: hits told from near misses, timed to a fraction of a frame."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from curlshot.data.tracks import Table
from curlshot.physics.local_fit.candidate_pruning import prune_candidates
from curlshot.physics.local_fit.candidates import LONG, REACH, candidates, in_causal_order, moves
from curlshot.physics.local_fit.fit import fit_shot
from curlshot.physics.local_fit.glides import free
from curlshot.physics.local_fit.segments import Piece, cut
from curlshot.physics.local_fit.solution import ContactState, LocalFit, Meeting
from curlshot.physics.local_fit.traces import Trace, traces

Floats = NDArray[np.float64]

SIGNIFICANT = 5.0
"""Normalised impulse below which two stones have passed each other."""

DISPLACED = 5 / 3
"""How much more counts the only hit of a stone at rest that lies elsewhere afterwards."""

MOST_PUSH = 3.0
"""Most that a hit can change the relative speed of two stones, in closing speeds (1 + e)."""

SHARE = 0.15
"""Smallest part of the other's change of velocity that a stone must show in a hit."""

MOST_RUB = 1.0
"""Most that two stones rub on each other in a hit, in what pushes them apart: curling stones 0.2 at
most. A stone that was at rest goes on along the line of the centres, but for that."""

MOST_PASSED = 3
"""Detections past which the time of a hit may go where no gap lets it go farther."""

MOST_RESTARTS = 4
"""How often a search goes on from where hits lie past so many."""


@dataclass(frozen=True)
class HitCandidate:
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


def detect_hits(detections: Table, radius: float) -> tuple[HitCandidate, ...]:
    """Find the hits between the stones of a table of detections.

    Every approach of two stones to about 2R is a candidate. All are fitted at once as hits, and the
    one whose impulse is least significant is struck off until all that are left changed the motion
    of both their stones, or passed on an impulse that can have come no other way. Where several
    show no hit (of those between two detections none is seen by itself), one that stays out of
    reach goes first, then one that pushes nothing, of these one of two stones that others set off
    in the same gap, and then the pair that lies farthest from touching. A pair hits again only
    after something else came between.

    Parameters
    ----------
    detections : Table
        Of `curlshot.data.tracks.DETECTION_COLUMNS` at least ``stone, t, x, y``.
    radius : float
        Of the discs, m.

    Returns
    -------
    tuple of HitCandidate
        In order of time.
    """
    known = traces(detections)
    meetings = prune_candidates(candidates(known, radius), known)
    cuts: dict[str, list[Piece]] = {}
    ordered, restarts = False, MOST_RESTARTS
    law = replace(free(radius), along=0.5, across=0.5)
    while meetings:
        pieces, cuts = cut_all(known, meetings, radius, cuts)
        fit = fit_shot(known, pieces, meetings, radius, deceleration=law)
        other = None if ordered else _reordered(fit, known)
        if other is not None:
            meetings, cuts, ordered = other, {}, True
            continue
        evidence = [_evidence(fit, k, known, radius) for k in range(len(meetings))]
        evidence = _needed(_once(evidence, fit), fit)
        weakest = min(range(len(meetings)), key=evidence.__getitem__)
        significant = evidence[weakest].hit >= SIGNIFICANT
        if significant:
            misplaced = _past(fit, range(len(meetings)), known, MOST_PASSED)
        else:
            misplaced = _ended(fit, weakest) | _past(fit, [weakest], known, MOST_PASSED + 1)
        if misplaced and restarts:
            meetings, restarts = _at_times(fit), restarts - 1
            cuts = {name: run for name, run in cuts.items() if name not in misplaced}
            continue
        if significant:
            return _contacts(fit)
        struck = meetings[weakest]
        meetings = [meeting for meeting in meetings if meeting is not struck]
        cuts = {name: run for name, run in cuts.items() if name not in struck.stones}
        cuts, ordered = _renumbered(cuts, weakest), False
    return ()


def _displaced(fit: LocalFit, k: int, known: Mapping[str, Trace], radius: float) -> bool:
    """Whether a stone that rested, and has no meeting but k, lies elsewhere afterwards."""
    return any(
        fit.pieces[fit.sides[k, stone][0]].rest
        and sum(stone in meeting.stones for meeting in fit.meetings) == 1
        and moves(known[stone], fit.time(k), radius, LONG)
        for stone in fit.meetings[k].stones
    )


def _reordered(fit: LocalFit, known: Mapping[str, Trace]) -> list[Meeting] | None:
    """Meetings of a fit at the times that it found, if cause asks for another order; else None."""
    met = sorted(_at_times(fit), key=lambda meeting: meeting.t)
    other = in_causal_order(met, known)
    return other if [m.stones for m in other] != [m.stones for m in met] else None


def _at_times(fit: LocalFit) -> list[Meeting]:
    """Give the meetings of a fit at the times that it found."""
    return [replace(m, t=fit.time(k)) for k, m in enumerate(fit.meetings)]


def _past(fit: LocalFit, asked: Iterable[int], known: Mapping[str, Trace], most: int) -> set[str]:
    """Stones of the meetings asked for whose times went past as many detections, or more.

    These lie on the wrong side of the meeting: of one that was sought in a gap, all of those from
    the end of the gap to the hit.
    """
    out: set[str] = set()
    for k in asked:
        meeting = fit.meetings[k]
        ends = (meeting.t, fit.time(k))
        if any(np.ptp(np.searchsorted(known[s].t, ends)) >= most for s in meeting.stones):
            out.update(meeting.stones)
    return out


def _ended(fit: LocalFit, k: int) -> set[str]:
    """Stones of meeting k if the fit has one at rest by then on the path that opens with it.

    A stone that was hit moves. Of one at rest neither detections nor momentum tell how fast it was,
    so that its error has no bounds: the first guess of the time was too far off.
    """
    stones = fit.meetings[k].stones
    at_rest = any(fit.stop(fit.sides[k, stone][1]) <= fit.time(k) for stone in stones)
    return {*stones} if at_rest else set()


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
    meetings: Sequence[Meeting | HitCandidate],
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


class _Evidence(NamedTuple):
    """What speaks for a meeting, in the order in which it counts.

    Attributes
    ----------
    hit : float
        How many standard errors its impulse is away from none; 0 if it can be no hit as it is.
    met : bool
        Whether they came within reach of each other at all.
    pushed : bool
        Whether anything drove its stones apart.
    seen : int
        How many of its stones were seen between it and what set them off. Where none was, other
        hits in the same gap have set off both, and there need not have been this one.
    near : float
        Minus how far they are from touching, in units of 2R.
    """

    hit: float
    met: bool
    pushed: bool
    seen: int
    near: float


def _evidence(fit: LocalFit, k: int, known: Mapping[str, Trace], radius: float) -> _Evidence:
    """Tell what speaks for meeting k."""

    def told(states: Sequence[ContactState]) -> Floats:
        state = states[0]
        change = state.after - state.before
        first, second = change @ state.normal
        closing = float((state.before[0] - state.before[1]) @ state.normal)
        impulse = 0.5 * (change[1] - change[0])
        nx, ny = state.normal
        rub = 2 * float(impulse @ [-ny, nx])
        return np.array([*impulse, second - first, -first, second, closing, rub])

    value, cov = fit.propagate([k], told)
    impulse, push = value[:2], value[2:]
    both = float(np.sqrt(impulse @ np.linalg.solve(cov[:2, :2] + 1e-12 * np.eye(2), impulse)))
    error = np.sqrt(np.diag(cov)[2:])
    state = fit.contact_state(k)
    away = abs(float(np.hypot(*(state.places[1] - state.places[0]))) / (2 * radius) - 1)
    pushed = bool(push[0] >= 3 * error[0])
    met = away <= REACH - 1
    possible = met and pushed and push[0] >= 0.2 * radius
    possible &= bool(push[3] + 2 * error[3] >= push[0] / MOST_PUSH)
    possible &= bool(np.min(push[1:3] + 2 * error[1:3]) >= SHARE * np.max(push[1:3]))
    possible &= bool(abs(push[4]) - 2 * error[4] <= MOST_RUB * push[0])
    if possible and _displaced(fit, k, known, radius):
        both *= DISPLACED
    seen = sum(
        len(fit.pieces[fit.sides[k, stone][0]].samples) > 0 for stone in fit.meetings[k].stones
    )
    return _Evidence(both if possible else 0.0, met, pushed, seen, -away)


def _once(evidence: Sequence[_Evidence], fit: LocalFit) -> list[_Evidence]:
    """Of two meetings of a pair without anything between them, leave no evidence for the weaker.

    Stones that hit each other go apart, and ice does not bring them together again: before they
    hit once more, another hit or a break changes the motion of one of them.
    """
    out = list(evidence)
    for k, meeting in enumerate(fit.meetings):
        since = {fit.pieces[fit.sides[k, stone][0]].opens for stone in meeting.stones}
        before = since.pop()
        if before is not None and not since:
            weaker = min(before, k, key=evidence.__getitem__)
            out[weaker] = evidence[weaker]._replace(hit=0.0)
    return out


def _needed(evidence: Sequence[_Evidence], fit: LocalFit) -> list[_Evidence]:
    """Let a meeting that set off a stone at rest count as much as the hit of it that follows.

    If that stone meets another one at rest, something drove it. What did is hardly seen by itself
    where the stone passes the impulse on at once and stays, as in a row of touching stones.
    """
    out = list(evidence)
    for k in reversed(range(len(fit.meetings))):
        for stone in fit.meetings[k].stones:
            before, after = fit.sides[k, stone]
            caused = fit.pieces[after].closes
            if not fit.pieces[before].rest or caused is None or -out[k].near > REACH - 1:
                continue
            (other,) = {*fit.meetings[caused].stones} - {stone}
            if fit.pieces[fit.sides[caused, other][0]].rest:
                out[k] = out[k]._replace(hit=max(out[k].hit, out[caused].hit))
    return out


def _contacts(fit: LocalFit) -> tuple[HitCandidate, ...]:
    out = []
    for k, meeting in enumerate(fit.meetings):
        state = fit.contact_state(k)
        first, second = meeting.stones
        nx, ny = (float(value) for value in state.normal)
        if np.hypot(*state.before[1]) > np.hypot(*state.before[0]):
            first, second, nx, ny = second, first, -nx, -ny
        out.append(HitCandidate(state.t, fit.stderr_time(k), (first, second), (nx, ny)))
    return tuple(sorted(out, key=lambda contact: contact.t))
